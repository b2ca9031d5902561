// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>

#include "lidarena/base/se3.hpp"
#include "lidarena/base/trajectory.hpp"

namespace lidarena {

/// The estimate of the truth's body, from an estimate of a frame fixed to it: body_from_estimate is
/// that frame's pose in the body (what `--lever` gives). Each pose becomes
/// world_from_estimate * body_from_estimate^-1. World alignment can never do this.
Trajectory moved_to_body(const Trajectory& estimate, const Pose& body_from_estimate);

/// Where the estimate's body frame seems to lie in the truth's: a diagnosis, never applied.
struct LeverArm {
  Pose body_from_estimate = Pose::Identity();
  /// Formal uncertainty of its translation (m) and, turned about its own axes, its rotation (rad);
  /// large where the flight does not show it (a flight that only yaws says nothing of z).
  se3::Vector6 sigma = se3::Vector6::Zero();
  double misfit_without_m = 0.0;  ///< RMS of the motions' difference over 1 s, frames as they are
  double misfit_m = 0.0;          ///< and with the arm
};

/// Hand-eye calibration: the constant X with rel(Q) X = X rel(P) of least squares over motions of
/// one second. Empty with fewer than ten of them, or when the body hardly turns (RMS under 1 deg a
/// second): then no arm can be seen.
std::optional<LeverArm> find_lever_arm(const Trajectory& estimate, const Trajectory& truth);

/// A warning in words when the arm is clearly there: beyond three sigma and 1 cm or 0.01 rad, and
/// the motions agree at least twice as well with it; else empty.
std::string warning_of(const LeverArm& arm);

}  // namespace lidarena
