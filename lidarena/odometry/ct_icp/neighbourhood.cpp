// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/odometry/ct_icp/neighbourhood.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

namespace lidarena::ct_icp {

namespace {

constexpr double kDistinct = 0.8;            // linearity or planarity from which it is one
constexpr double kDistributionWeight = 0.1;  // of neither
constexpr double kThinnest = 0.02;           // m, least deviation of a distribution: range noise

Eigen::Vector3d anchor_of(std::span<const VoxelHashMap::Neighbor> neighbours,
                          const Eigen::Vector3d& mean, PlanePoint plane_point) {
  if (plane_point == PlanePoint::kMean) return mean;
  const auto [nearest, farthest] = std::minmax_element(
      neighbours.begin(), neighbours.end(),
      [](const auto& a, const auto& b) { return a.squared_distance < b.squared_distance; });
  return (plane_point == PlanePoint::kNearest ? nearest : farthest)->point->cast<double>();
}

}  // namespace

Neighbourhood describe(std::span<const VoxelHashMap::Neighbor> neighbours, PlanePoint plane_point) {
  const Eigen::Vector3f& origin = *neighbours.front().point;
  Eigen::Vector3f sum = Eigen::Vector3f::Zero();
  Eigen::Matrix3f squares = Eigen::Matrix3f::Zero();
  for (const auto& neighbour : neighbours) {
    const Eigen::Vector3f d = *neighbour.point - origin;  // small, so floats do
    sum += d;
    squares += d * d.transpose();
  }
  const auto count = static_cast<double>(neighbours.size());
  const Eigen::Vector3d mean = sum.cast<double>() / count;
  const Eigen::Matrix3d covariance = squares.cast<double>() / count - mean * mean.transpose();
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
  solver.computeDirect(covariance);

  Neighbourhood result;
  result.anchor = anchor_of(neighbours, mean + origin.cast<double>(), plane_point);
  result.normal = solver.eigenvectors().col(0);
  result.line = solver.eigenvectors().col(2);
  result.eigenvalues = solver.eigenvalues().cwiseMax(0.0);
  const Eigen::Vector3d s = result.eigenvalues.cwiseSqrt();
  if (s[2] > 0.0) {
    result.planarity = (s[1] - s[0]) / s[2];
    result.linearity = (s[2] - s[1]) / s[2];
  }
  return result;
}

ElasticMatch plane_match(const Neighbourhood& neighbourhood, const Eigen::Vector3d& keypoint,
                         const RegistrationConfig& config) {
  const double reach = config.max_plane_distance_m * config.min_neighbours;
  const double nearness = std::exp(-(neighbourhood.anchor - keypoint).norm() / reach);
  ElasticMatch match;
  match.anchor = neighbourhood.anchor;
  match.shape.row(0) = neighbourhood.normal;
  match.weight = (config.planarity_weight * neighbourhood.planarity * neighbourhood.planarity +
                  config.nearness_weight * nearness) /
                 (config.planarity_weight + config.nearness_weight);
  return match;
}

ElasticMatch shape_match(const Neighbourhood& neighbourhood) {
  ElasticMatch match;
  match.anchor = neighbourhood.anchor;
  if (neighbourhood.planarity > kDistinct) {
    match.shape.row(0) = neighbourhood.normal;
    match.weight = neighbourhood.planarity * neighbourhood.planarity;
  } else if (neighbourhood.linearity > kDistinct) {
    match.rows = 3;
    match.shape = Eigen::Matrix3d::Identity() - neighbourhood.line * neighbourhood.line.transpose();
    match.weight = neighbourhood.linearity * neighbourhood.linearity;
  } else {
    // Deviations along the axes, scaled so that the smallest counts in metres as a plane's does.
    const Eigen::Vector3d deviations = neighbourhood.eigenvalues.cwiseSqrt().cwiseMax(kThinnest);
    Eigen::Matrix3d axes;
    axes << neighbourhood.normal, neighbourhood.line.cross(neighbourhood.normal),
        neighbourhood.line;
    match.rows = 3;
    match.shape = (deviations[0] * deviations.cwiseInverse()).asDiagonal() * axes.transpose();
    match.weight = kDistributionWeight;
  }
  return match;
}

}  // namespace lidarena::ct_icp
