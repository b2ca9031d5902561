// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "lidarena/base/pose.hpp"
#include "lidarena/flight/imu_spline_fit.hpp"
#include "lidarena/flight/pose_spline_flight.hpp"

namespace lidarena::flight {

/// A flight along the motion that fit_imu_spline() found, with the samples of the real IMU.
class RecordedImuFlight final : public Flight {
 public:
  /// `samples` have the recording's stamps, of which `start` is time 0; empty: IMUs are simulated.
  /// Throws InputError (place `name`) if `world_from_recording` tilts the vertical, which gravity
  /// in the samples shows, or `recorded_from_body` moves the body's origin away from the IMU.
  RecordedImuFlight(ImuSplineFit fit, const std::vector<ImuSample>& samples, Time start,
                    const Pose& world_from_recording, const Pose& recorded_from_body,
                    const std::string& name);

  Motion at(Time t) const override { return spline_.at(t); }
  Pose pose_at(Time t) const override { return spline_.pose_at(t); }
  Time duration() const override { return spline_.duration(); }
  const RecordedImu* recorded_imu() const override { return imu_ ? &*imu_ : nullptr; }

 private:
  PoseSplineFlight spline_;
  std::optional<RecordedImu> imu_;
};

}  // namespace lidarena::flight
