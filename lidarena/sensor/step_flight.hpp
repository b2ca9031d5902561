// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>

#include "lidarena/base/trajectory.hpp"
#include "lidarena/flight/flight.hpp"

namespace lidarena::sensor {

/// Motion around the middle one of three consecutive poses, as a simulator with time steps gives
/// them. Position and rotation vector are quadratic in time, so rates and accelerations at the
/// middle pose are central differences, with errors of h^2 / 6 times a third derivative and
/// h^2 / 12 times a fourth (h: the step).
class StepFlight : public flight::Flight {
 public:
  /// Stamps must strictly increase.
  explicit StepFlight(const std::array<StampedPose, 3>& poses);

  flight::Motion at(Time t) const override;
  /// Instant of the last pose.
  Time duration() const override { return end_; }

 private:
  Time middle_time_, end_;
  Pose middle_;
  Eigen::Vector3d velocity_, acceleration_;      ///< world frame
  Eigen::Vector3d rate_, angular_acceleration_;  ///< frame of the middle pose
};

}  // namespace lidarena::sensor
