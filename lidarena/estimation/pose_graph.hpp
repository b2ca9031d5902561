// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "lidarena/base/pose.hpp"
#include "lidarena/estimation/robust_kernel.hpp"

namespace lidarena {

/// Robust kernel of a measurement, on its Mahalanobis distance.
struct RobustLoss {
  RobustKernel kernel = RobustKernel::kNone;
  double scale = 1.0;  ///< in sigmas of the whole measurement
};

/// Poses in the world and what was measured of them, all rigid in SE(3): the back end of a SLAM
/// with keyframes (Grisetti, Kuemmerle, Stachniss, Burgard, "A Tutorial on Graph-Based SLAM", IEEE
/// ITS Magazine 2010). Covariances are of (translation in m, rotation in rad), both in the frame of
/// the node that is measured from; they must be positive definite.
struct PoseGraph {
  using Covariance = Eigen::Matrix<double, 6, 6>;

  /// Node `node` stands at this pose.
  struct Prior {
    std::size_t node = 0;
    Pose world_from_node = Pose::Identity();
    Covariance covariance = Covariance::Identity();
  };
  /// Node `second` stands like this when seen from node `first`: odometry, or a loop.
  struct Between {
    std::size_t first = 0;
    std::size_t second = 0;
    Pose first_from_second = Pose::Identity();
    Covariance covariance = Covariance::Identity();
    RobustLoss loss{};
  };
  /// Node `node` is at this place (satellite navigation, a marker), m.
  struct Position {
    std::size_t node = 0;
    Eigen::Vector3d position = Eigen::Vector3d::Zero();
    Eigen::Matrix3d covariance = Eigen::Matrix3d::Identity();
    RobustLoss loss{};
  };

  std::vector<Pose> nodes;  ///< world_from_node, as far as known
  std::vector<Prior> priors;
  std::vector<Between> betweens;
  std::vector<Position> positions;
};

/// Squared Mahalanobis distance of a measurement from the nodes as they stand; chi-squared with 6
/// degrees of freedom when all is as modeled.
double squared_mahalanobis(const PoseGraph& graph, const PoseGraph::Between& measurement);

struct PoseGraphSolution {
  std::vector<Pose> nodes;
  double initial_cost = 0.0;  ///< half the sum of (robust) squared Mahalanobis distances
  double final_cost = 0.0;
  int iterations = 0;
  bool converged = false;  ///< false: `nodes` are as they were given, or the best found in time
};

/// The nodes that fit all measurements best (Levenberg-Marquardt from where they stand). Without a
/// prior or position the first node stays where it is. One thread: the same bits each time.
/// Throws InputError when a node is not finite, or a measurement names a node that is not there or
/// has a covariance that is not positive definite.
PoseGraphSolution optimize(const PoseGraph& graph, int max_iterations = 50);

}  // namespace lidarena
