// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "lidarena/base/pose.hpp"
#include "lidarena/estimation/least_squares.hpp"

namespace lidarena::estimation {

/// Pose of a moving body and the first two derivatives of its motion.
struct MotionState {
  Pose pose = Pose::Identity();                                    ///< world from body
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();              ///< m/s, world
  Eigen::Vector3d acceleration = Eigen::Vector3d::Zero();          ///< m/s^2, world
  Eigen::Vector3d rate = Eigen::Vector3d::Zero();                  ///< rad/s, body
  Eigen::Vector3d angular_acceleration = Eigen::Vector3d::Zero();  ///< rad/s^2, body

  /// The pose `seconds` later (or earlier, if negative), with constant accelerations: for times so
  /// short that they do not change.
  Pose pose_after(double seconds) const;
};

/// Errors of a state: position (world), rotation (body, on the right), velocity, rate,
/// acceleration, angular acceleration.
constexpr int kMotionDof = 18;
using MotionVector = Eigen::Matrix<double, kMotionDof, 1>;
using MotionMatrix = Eigen::Matrix<double, kMotionDof, kMotionDof>;

MotionState operator+(const MotionState& state, const MotionVector& error);
/// The error that leads from `from` to `to`.
MotionVector operator-(const MotionState& to, const MotionState& from);

/// A state and the covariance of its error.
struct MotionEstimate {
  MotionState state;
  MotionMatrix covariance = MotionMatrix::Zero();
};

/// How accelerations behave: of zero mean, correlated over a time (R. Singer, "Estimating Optimal
/// Tracking Filter Performance for Manned Maneuvering Targets", IEEE T-AES 1970).
struct ManeuverModel {
  double acceleration = 5.0;           ///< m/s^2, standard deviation, each axis
  double acceleration_time = 0.3;      ///< s, after which the correlation is 1/e
  double angular_acceleration = 20.0;  ///< rad/s^2, standard deviation, each axis
  double angular_time = 0.1;           ///< s, likewise
};

/// An estimate carried to a later instant.
struct MotionPrediction {
  MotionEstimate estimate;
  MotionMatrix transition = MotionMatrix::Identity();  ///< from the error before to that after
};
MotionPrediction predicted(const MotionEstimate& estimate, double seconds,
                           const ManeuverModel& model);

/// Update by measurements of the pose alone (position, rotation), linearized at `state`: the
/// minimum of their cost, of which `equations` are the derivatives in units of its variance, and of
/// the distance from the prior. Its covariance follows if `state` is the minimum.
MotionEstimate updated(const MotionEstimate& prior, const MotionState& state,
                       const NormalEquations<6>& equations);

/// One step of a filter: what was predicted from the step before, and what it was updated to.
struct MotionStep {
  MotionPrediction prediction;
  MotionEstimate estimate;
};
/// The estimates of a filter's steps given the measurements of all of them (H. Rauch, F. Tung, C.
/// Striebel, "Maximum Likelihood Estimates of Linear Dynamic Systems", AIAA Journal 1965).
std::vector<MotionEstimate> smoothed(std::span<const MotionStep> steps);

}  // namespace lidarena::estimation
