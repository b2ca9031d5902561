// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>

#include "lidarena/base/se3.hpp"
#include "lidarena/base/trajectory.hpp"

namespace lidarena::evaluation {

/// Converts an estimate of a frame fixed to the body into an estimate of the truth's body frame.
/// body_from_estimate is the pose of that frame in the body (option `--lever`). Each pose becomes
/// world_from_estimate * body_from_estimate^-1. Aligning the world frames cannot correct a lever
/// arm.
Trajectory moved_to_body(const Trajectory& estimate, const Pose& body_from_estimate);

/// The same poses in a world frame whose origin lies at -`offset`, m.
Trajectory moved_by(const Trajectory& trajectory, const Eigen::Vector3d& offset);

/// Estimated pose of the estimate's body frame in the truth's body frame: a diagnostic, never
/// applied.
struct LeverArm {
  Pose body_from_estimate = Pose::Identity();
  /// Formal standard deviation of the translation (m) and of the rotation about the estimate's own
  /// axes (rad); large where the motion does not determine it (pure yaw does not determine z).
  se3::Vector6 sigma = se3::Vector6::Zero();
  double misfit_without_m = 0.0;  ///< RMS difference of the motions over 1 s without the arm
  double misfit_m = 0.0;          ///< the same with the arm
};

/// Hand-eye calibration: the least-squares constant X with rel(Q) X = X rel(P) over motions of one
/// second. Empty with fewer than ten motions, or when the body rotates less than 1 deg per second
/// (RMS): then no arm is observable.
std::optional<LeverArm> find_lever_arm(const Trajectory& estimate, const Trajectory& truth);

/// A warning text when the arm is significant: beyond three sigma and 1 cm or 0.01 rad, and the
/// motions agree at least twice as well with it; else empty.
std::string warning_of(const LeverArm& arm);

}  // namespace lidarena::evaluation
