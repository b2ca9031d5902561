// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <span>

#include "lidarena/base/parallel.hpp"
#include "lidarena/base/pose.hpp"
#include "lidarena/odometry/ct_icp/elastic_motion.hpp"

namespace lidarena::odometry::ct_icp {

/// A point of a scan and a plane of the map on which it should lie. error = weight * normal .
/// (position - anchor).
struct ElasticMatch {
  Eigen::Vector3d point;   ///< m, lidar frame
  double alpha = 0.0;      ///< time of the point: 0 first, 1 last instant of the scan
  Eigen::Vector3d anchor;  ///< m, world: a point of the plane
  Eigen::Vector3d normal;  ///< unit, world
  double weight = 1.0;     ///< of the error, not of its square
};

/// Smallest share of a direction in the normals of the matches: 1/3 if they are isotropic, 0 if
/// the matches leave a direction unobservable.
double observability_of(std::span<const ElasticMatch> matches);

/// The expected motion, known before the points are used (CT-ICP, III-C). Each weight is relative
/// to the mean squared error of a point, so it has no unit for positions, m^2 for rotations; 0
/// disables the term.
struct MotionPrior {
  Pose begin = Pose::Identity();                   ///< expected begin
  Eigen::Vector3d step = Eigen::Vector3d::Zero();  ///< m, expected from begin to end, world

  // Weights of the terms, each of which states:
  double location = 0.0;  ///< the begin's position is that of `begin`
  /// Its rotation is that of `begin`: the error is 1 - <q, q_begin>^2 of unit quaternions =
  /// sin^2(angle / 2).
  double orientation = 0.0;
  double velocity = 0.0;        ///< the translation from begin to end is `step`
  double small_velocity = 0.0;  ///< the translation from begin to end is zero
};

struct ElasticProblem {
  std::span<const ElasticMatch> matches;
  MotionPrior prior;
  double kernel_scale = 0.1;  ///< m, scale of the Cauchy kernel for the weighted error
};

/// The cost to minimize: 1/2 sum of losses; with N matches, each term of the prior counts N times.
double cost_of(const ElasticProblem& problem, const ElasticMotion& motion);

/// Up to `iterations` trial steps of Levenberg-Marquardt, which ends earlier when a step changes
/// the cost by less than 1e-6 of it. Each parameter is damped in proportion to its own curvature;
/// the damping follows the ratio of actual to predicted gain (Madsen, Nielsen, Tingleff, "Methods
/// for Non-linear Least Squares Problems", 2004, section 3.2). Bit-identical for any number of
/// threads.
ElasticMotion align(const ElasticProblem& problem, ElasticMotion motion, int iterations,
                    const Parallel& parallel);

}  // namespace lidarena::odometry::ct_icp
