// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "lidarena/base/pose.hpp"
#include "lidarena/estimation/robust_kernel.hpp"

namespace lidarena::estimation {

/// Robust kernel of a measurement, on its Mahalanobis distance.
struct RobustLoss {
  RobustKernel kernel = RobustKernel::kNone;
  double scale = 1.0;  ///< in sigmas of the whole measurement
};

/// Poses in the world and measurements of them, all in SE(3): the back end of keyframe-based SLAM
/// (Grisetti, Kuemmerle, Stachniss, Burgard, "A Tutorial on Graph-Based SLAM", IEEE ITS Magazine
/// 2010). Covariances are of (translation in m, rotation in rad), both in the frame of the node
/// that is measured from; they must be positive definite.
struct PoseGraph {
  using Covariance = Eigen::Matrix<double, 6, 6>;

  /// A measured pose of node `node`.
  struct Prior {
    std::size_t node = 0;
    Pose world_from_node = Pose::Identity();
    Covariance covariance = Covariance::Identity();
  };
  /// A measured pose of node `second` relative to node `first`: odometry or a loop.
  struct Between {
    std::size_t first = 0;
    std::size_t second = 0;
    Pose first_from_second = Pose::Identity();
    Covariance covariance = Covariance::Identity();
    RobustLoss loss{};
  };
  /// A measured position (m) of node `node` (satellite navigation, a marker).
  struct Position {
    std::size_t node = 0;
    Eigen::Vector3d position = Eigen::Vector3d::Zero();
    Eigen::Matrix3d covariance = Eigen::Matrix3d::Identity();
    RobustLoss loss{};
  };

  std::vector<Pose> nodes;  ///< world_from_node, initial guesses
  std::vector<Prior> priors;
  std::vector<Between> betweens;
  std::vector<Position> positions;
};

/// The covariance with these variances on each axis, m^2 and rad^2.
PoseGraph::Covariance diagonal_covariance(double translation, double rotation);

/// Adds the next node of a chain, at its measured pose from the last one; `covariance` is that of
/// the measurement. The first node is measured from the world, and a prior holds it there.
void append_to_chain(const Pose& previous_from_next, const PoseGraph::Covariance& covariance,
                     PoseGraph& graph);

/// Of the nodes and the measurements between them.
std::uint64_t memory_bytes(const PoseGraph& graph);

/// Squared Mahalanobis distance of a measurement from the nodes of `graph`; chi-squared with 6
/// degrees of freedom if the model holds.
double squared_mahalanobis(const PoseGraph& graph, const PoseGraph::Between& measurement);

struct PoseGraphSolution {
  std::vector<Pose> nodes;
  double initial_cost = 0.0;  ///< half the sum of (robust) squared Mahalanobis distances
  double final_cost = 0.0;
  int iterations = 0;
  bool converged = false;  ///< false: `nodes` are as given, or the best of all iterations
};

/// The nodes that fit all measurements best (Levenberg-Marquardt, starting from `graph.nodes`).
/// Without a prior or position the first node is fixed. Single-threaded: bit-identical each time.
/// Throws InputError when a node is not finite, or a measurement names a node that does not exist
/// or has a covariance that is not positive definite.
PoseGraphSolution optimize(const PoseGraph& graph, int max_iterations = 50);

}  // namespace lidarena::estimation
