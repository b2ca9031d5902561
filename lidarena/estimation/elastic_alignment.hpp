// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <span>

#include "lidarena/base/parallel.hpp"
#include "lidarena/base/pose.hpp"
#include "lidarena/estimation/elastic_motion.hpp"
#include "lidarena/estimation/robust_kernel.hpp"

namespace lidarena {

/// A point of a scan and what it should lie on: error = weight * shape * (position - anchor).
struct ElasticMatch {
  Eigen::Vector3d point;   ///< m, lidar frame
  double alpha = 0.0;      ///< when it was measured, 0 the scan's first instant, 1 its last
  Eigen::Vector3d anchor;  ///< m, world
  /// Rows of the error: a plane's normal (1 row), or a full matrix (3 rows), as I - d d^T for a
  /// line along d, or the square root of an inverse covariance.
  Eigen::Matrix3d shape;
  int rows = 1;         ///< 1 or 3
  double weight = 1.0;  ///< of the error, not of its square
};

/// What is expected of a motion before the points are looked at (CT-ICP, III-C). Each weight counts
/// against the mean squared error of a point, so it has no unit for a position, m^2/rad^2 for a
/// rotation; 0 switches the term off.
struct MotionPrior {
  Pose begin = Pose::Identity();                   ///< expected first knot
  Eigen::Vector3d step = Eigen::Vector3d::Zero();  ///< m, expected, from first knot to last, world
  Eigen::Vector3d turn = Eigen::Vector3d::Zero();  ///< rad, likewise, rotation vector in world

  double location = 0.0;          ///< first knot's position as expected
  double orientation = 0.0;       ///< first knot's rotation as expected
  double velocity = 0.0;          ///< step as expected
  double angular_velocity = 0.0;  ///< turn as expected
  double small_velocity = 0.0;    ///< step is zero
  double bend = 0.0;              ///< neighboring segments move alike, in position ...
  double angular_bend = 0.0;      ///< ... and in rotation
};

struct ElasticProblem {
  std::span<const ElasticMatch> matches;
  MotionPrior prior;
  RobustKernel kernel = RobustKernel::kCauchy;
  double kernel_scale = 0.1;  ///< m, of the weighted error
  bool exact_slerp = true;    ///< false: ElasticSegment::first_order_row (Gauss-Newton alone)
};

/// 1/2 sum of losses, as both solvers minimize it: with N matches, each term of the prior counts
/// N times.
double cost_of(const ElasticProblem& problem, const ElasticMotion& motion);

/// Up to `iterations` steps of iteratively re-weighted Gauss-Newton, with the block-tridiagonal
/// normal equations of 6 unknowns a knot. The same bits on any number of threads.
ElasticMotion align_by_gauss_newton(const ElasticProblem& problem, ElasticMotion motion,
                                    int iterations, const Parallel& parallel);

/// Up to `iterations` steps of Levenberg-Marquardt by Ceres (which ends earlier when a step lowers
/// the cost by less than 1e-6 of it).
ElasticMotion align_by_ceres(const ElasticProblem& problem, ElasticMotion motion, int iterations);

}  // namespace lidarena
