// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "lidarena/base/imu_sample.hpp"

namespace lidarena::dataset {

/// Standard gravity, m/s^2.
inline constexpr double kStandardGravity = 9.80665;

/// Factors from an IMU's values to m/s^2 and rad/s.
struct ImuUnits {
  double accel = 1.0;
  double gyro = 1.0;
  bool operator==(const ImuUnits&) const = default;
};

/// Accelerations in g, rates in rad/s, as Livox's drivers publish them.
inline constexpr ImuUnits kInG{kStandardGravity, 1.0};

struct ImuVerdict {
  ImuUnits units;
  std::vector<std::string> notes;     ///< units that were recognized
  std::vector<std::string> warnings;  ///< what cannot be right
};

/// Judges the units of an IMU by its first samples (some seconds). Gravity is in every sample of
/// an accelerometer, so that their magnitudes have a median of 1 (in g), 1000 (in mg) or 9.8; where
/// they scatter around it as only accelerations without gravity do, a warning states it. Rates
/// whose 90th percentile is beyond 5 rad/s (286 deg/s) are taken to be in deg/s. Samples that are
/// not finite or all zero are ignored.
ImuVerdict judge_imu(std::string_view topic, std::span<const ImuSample> samples);

/// Why a sample (in SI) cannot be a measurement; empty if it can: not finite, all zero, or beyond
/// what MEMS sensors measure (40 g, 80 rad/s).
std::string_view fault_of(const ImuSample& sample);

}  // namespace lidarena::dataset
