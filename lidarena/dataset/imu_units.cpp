// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/dataset/imu_units.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <numbers>
#include <optional>

namespace lidarena::dataset {
namespace {

struct AccelUnit {
  double scale;  ///< to m/s^2
  const char* name;
};
constexpr std::array kAccelUnits{AccelUnit{1.0, "m/s^2"}, AccelUnit{kStandardGravity, "g"},
                                 AccelUnit{kStandardGravity * 1e-3, "mg"},
                                 AccelUnit{1e-3, "mm/s^2"}};
/// Gravity as measured in motion: the median over seconds is within a third of it.
constexpr double kMinGravity = kStandardGravity / 1.5;
constexpr double kMaxGravity = kStandardGravity * 1.5;
/// Width of the middle 80 % of the magnitudes over their median. In violent flight it is 0.5; a
/// random vector without an offset has 1.1.
constexpr double kMaxSpread = 0.9;
constexpr double kMaxRate = 5.0;         // rad/s that a tenth of the samples exceeds
constexpr std::size_t kMinSamples = 20;  // fewer show nothing

/// Share of the mean vector in the mean magnitude: gravity is in all samples, motion averages out.
constexpr double kMinCoherence = 0.5;

/// Percentiles of magnitudes.
struct Spread {
  double p10 = 0.0, median = 0.0, p90 = 0.0;
};

Spread spread_of(std::vector<double> values) {
  std::ranges::sort(values);
  const auto at = [&](double share) {
    return values[static_cast<std::size_t>(share * static_cast<double>(values.size() - 1))];
  };
  return {at(0.1), at(0.5), at(0.9)};
}

std::optional<AccelUnit> unit_with_gravity(double median) {
  for (const AccelUnit& unit : kAccelUnits) {
    const double in_si = median * unit.scale;
    if (in_si > kMinGravity && in_si < kMaxGravity) return unit;
  }
  return std::nullopt;
}

/// Only motion of 1 g on average has the median of gravity in m/s^2; in other units the direction
/// must confirm it.
bool lacks_gravity(const Spread& accel, double coherence, const std::optional<AccelUnit>& unit) {
  const bool is_si = unit && unit->scale == 1.0;
  return accel.p90 - accel.p10 > kMaxSpread * accel.median || (!is_si && coherence < kMinCoherence);
}

void judge_accelerations(std::string_view topic, const Spread& accel, double coherence,
                         ImuVerdict& verdict) {
  const auto unit = unit_with_gravity(accel.median);
  if (lacks_gravity(accel, coherence, unit) || (!unit && accel.median < kMinGravity)) {
    verdict.warnings.push_back(fmt::format(
        "{}: the accelerations (median {:.3g}, 80 % within {:.3g} to {:.3g}) lack gravity; "
        "odometry "
        "with an IMU needs what the accelerometer measures, +9.8 m/s^2 upwards at rest: record the "
        "raw topic of the IMU",
        topic, accel.median, accel.p10, accel.p90));
  } else if (!unit) {
    verdict.warnings.push_back(
        fmt::format("{}: the accelerations have a median magnitude of {:.4g}, which is gravity "
                    "neither in m/s^2 "
                    "nor in g or mg; scale them to m/s^2",
                    topic, accel.median));
  } else if (unit->scale != 1.0) {
    verdict.units.accel = unit->scale;
    verdict.notes.push_back(
        fmt::format("{}: accelerations are taken to be in {}, judging by their magnitude ({:.4g})",
                    topic, unit->name, accel.median));
  }
}

void judge_rates(std::string_view topic, const Spread& gyro, ImuVerdict& verdict) {
  if (gyro.p90 < kMaxRate) return;
  verdict.units.gyro = std::numbers::pi / 180.0;
  verdict.notes.push_back(fmt::format(
      "{}: angular rates are taken to be in deg/s, judging by their magnitude (a tenth is beyond "
      "{:.3g})",
      topic, gyro.p90));
}

}  // namespace

std::string_view fault_of(const ImuSample& sample) {
  constexpr double kMaxAccel = 40.0 * kStandardGravity;
  constexpr double kMaxGyro = 80.0;
  if (!sample.gyro.allFinite() || !sample.accel.allFinite()) return "not finite";
  if (sample.gyro.isZero(0.0) && sample.accel.isZero(0.0)) return "all zero";
  if (sample.accel.norm() > kMaxAccel || sample.gyro.norm() > kMaxGyro)
    return "beyond 40 g or 80 rad/s";
  return {};
}

ImuVerdict judge_imu(std::string_view topic, std::span<const ImuSample> samples) {
  std::vector<double> accel, gyro;
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  double sum_of_magnitudes = 0.0;
  for (const ImuSample& sample : samples) {
    if (!sample.gyro.allFinite() || !sample.accel.allFinite()) continue;
    if (sample.accel.isZero(0.0)) continue;
    accel.push_back(sample.accel.norm());
    gyro.push_back(sample.gyro.norm());
    sum += sample.accel;
    sum_of_magnitudes += sample.accel.norm();
  }
  ImuVerdict verdict;
  if (accel.size() < kMinSamples) return verdict;
  judge_accelerations(topic, spread_of(std::move(accel)), sum.norm() / sum_of_magnitudes, verdict);
  judge_rates(topic, spread_of(std::move(gyro)), verdict);
  return verdict;
}

}  // namespace lidarena::dataset
