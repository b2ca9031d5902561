// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <span>

#include "lidarena/base/parallel.hpp"
#include "lidarena/base/pose.hpp"
#include "lidarena/estimation/elastic_motion.hpp"
#include "lidarena/estimation/robust_kernel.hpp"

namespace lidarena::estimation {

/// A point of a scan and a shape in the map that the point should lie on. error = weight * shape *
/// (position - anchor).
struct ElasticMatch {
  Eigen::Vector3d point;   ///< m, lidar frame
  double alpha = 0.0;      ///< time of the point: 0 first, 1 last instant of the scan
  Eigen::Vector3d anchor;  ///< m, world: a point of the shape
  /// Rows of the error: the normal of a plane (1 row), or a full matrix (3 rows), e.g. I - d d^T
  /// for a line along d, or the square root of an inverse covariance.
  Eigen::Matrix3d shape;
  int rows = 1;         ///< 1 or 3
  double weight = 1.0;  ///< of the error, not of its square
};

/// The expected motion, known before the points are used (CT-ICP, section III-C). Each weight is
/// relative to the mean squared error of a point, so it has no unit for positions, m^2/rad^2 for
/// rotations; 0 disables the term.
struct MotionPrior {
  Pose begin = Pose::Identity();                   ///< expected first knot
  Eigen::Vector3d step = Eigen::Vector3d::Zero();  ///< m, expected from first to last knot, world
  Eigen::Vector3d turn = Eigen::Vector3d::Zero();  ///< rad, likewise, rotation vector in world

  // Weights of the terms, each of which states:
  double location = 0.0;                 ///< the first knot's position is that of `begin`
  double orientation = 0.0;              ///< the first knot's rotation is that of `begin`
  double velocity = 0.0;                 ///< the translation from first to last knot is `step`
  double angular_velocity = 0.0;         ///< the rotation from first to last knot is `turn`
  double small_velocity = 0.0;           ///< the translation from first to last knot is zero
  double velocity_change = 0.0;          ///< the second differences of positions are zero
  double angular_velocity_change = 0.0;  ///< the second differences of rotations are zero
};

struct ElasticProblem {
  std::span<const ElasticMatch> matches;
  MotionPrior prior;
  RobustKernel kernel = RobustKernel::kCauchy;
  double kernel_scale = 0.1;  ///< m, scale of the kernel for the weighted error
  bool exact_slerp = true;    ///< false: ElasticSegment::first_order_row (Gauss-Newton only)
};

/// The cost that both solvers minimize: 1/2 sum of losses; with N matches, each term of the prior
/// counts N times.
double cost_of(const ElasticProblem& problem, const ElasticMotion& motion);

/// Up to `iterations` steps of iteratively re-weighted Gauss-Newton, with block-tridiagonal normal
/// equations of 6 unknowns per knot. Bit-identical for any number of threads.
ElasticMotion align_by_gauss_newton(const ElasticProblem& problem, ElasticMotion motion,
                                    int iterations, const Parallel& parallel);

/// Up to `iterations` steps of Levenberg-Marquardt with Ceres, which stops earlier when a step
/// lowers the cost by less than 1e-6 of it.
ElasticMotion align_by_ceres(const ElasticProblem& problem, ElasticMotion motion, int iterations);

}  // namespace lidarena::estimation
