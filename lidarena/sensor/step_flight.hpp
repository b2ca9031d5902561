// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>

#include "lidarena/base/trajectory.hpp"
#include "lidarena/flight/flight.hpp"

namespace lidarena {

/// The motion about the middle one of three poses that follow each other, as of a simulator that
/// goes by steps: position and rotation vector are quadratic in time, so that rates and
/// accelerations at the middle pose are central differences, off by h^2 / 6 times a third
/// derivative and h^2 / 12 times a fourth (h the step).
class StepFlight : public Flight {
 public:
  /// Stamps must strictly increase.
  explicit StepFlight(const std::array<StampedPose, 3>& poses);

  Motion at(Time t) const override;
  /// Instant of the last pose.
  Time duration() const override { return end_; }

 private:
  Time middle_time_, end_;
  Pose middle_;
  Eigen::Vector3d velocity_, acceleration_;      ///< world frame
  Eigen::Vector3d rate_, angular_acceleration_;  ///< frame of the middle pose
};

}  // namespace lidarena
