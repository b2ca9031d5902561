// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/odometry/arena_lo/neighborhood.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

namespace lidarena::odometry::arena_lo {

namespace {

constexpr double kMinDistinctness = 0.8;     // minimum planarity of a plane, linearity of a line
constexpr double kDistributionWeight = 0.1;  // of a neighborhood that is neither
constexpr double kMinDeviation = 0.02;       // m, minimum deviation of a distribution: range noise

Eigen::Vector3d anchor_of(std::span<const map::Neighbor> neighbors, const Eigen::Vector3d& mean,
                          PlanePoint plane_point) {
  if (plane_point == PlanePoint::kMean) return mean;
  const auto [nearest, farthest] = std::minmax_element(
      neighbors.begin(), neighbors.end(),
      [](const auto& a, const auto& b) { return a.squared_distance < b.squared_distance; });
  return (plane_point == PlanePoint::kNearest ? nearest : farthest)->point.cast<double>();
}

}  // namespace

Neighborhood describe(std::span<const map::Neighbor> neighbors, PlanePoint plane_point) {
  const Eigen::Vector3f& origin = neighbors.front().point;
  Eigen::Vector3f sum = Eigen::Vector3f::Zero();
  Eigen::Matrix3f squares = Eigen::Matrix3f::Zero();
  for (const auto& neighbor : neighbors) {
    const Eigen::Vector3f d = neighbor.point - origin;  // small, so float precision suffices
    sum += d;
    squares += d * d.transpose();
  }
  const auto count = static_cast<double>(neighbors.size());
  const Eigen::Vector3d mean = sum.cast<double>() / count;
  const Eigen::Matrix3d covariance = squares.cast<double>() / count - mean * mean.transpose();
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
  solver.computeDirect(covariance);

  Neighborhood result;
  result.anchor = anchor_of(neighbors, mean + origin.cast<double>(), plane_point);
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

estimation::ElasticMatch plane_match(const Neighborhood& neighborhood,
                                     const Eigen::Vector3d& keypoint,
                                     const RegistrationConfig& config) {
  const double reach = config.max_plane_distance_m * config.min_neighbors;
  const double nearness = std::exp(-(neighborhood.anchor - keypoint).norm() / reach);
  estimation::ElasticMatch match;
  match.anchor = neighborhood.anchor;
  match.shape.row(0) = neighborhood.normal;
  match.weight = (config.planarity_weight * neighborhood.planarity * neighborhood.planarity +
                  config.proximity_weight * nearness) /
                 (config.planarity_weight + config.proximity_weight);
  return match;
}

estimation::ElasticMatch shape_match(const Neighborhood& neighborhood) {
  estimation::ElasticMatch match;
  match.anchor = neighborhood.anchor;
  if (neighborhood.planarity > kMinDistinctness) {
    match.shape.row(0) = neighborhood.normal;
    match.weight = neighborhood.planarity * neighborhood.planarity;
  } else if (neighborhood.linearity > kMinDistinctness) {
    match.rows = 3;
    match.shape = Eigen::Matrix3d::Identity() - neighborhood.line * neighborhood.line.transpose();
    match.weight = neighborhood.linearity * neighborhood.linearity;
  } else {
    // Deviations along the axes, scaled so that the smallest one is in meters, as for a plane.
    const Eigen::Vector3d deviations = neighborhood.eigenvalues.cwiseSqrt().cwiseMax(kMinDeviation);
    Eigen::Matrix3d axes;
    axes << neighborhood.normal, neighborhood.line.cross(neighborhood.normal), neighborhood.line;
    match.rows = 3;
    match.shape = (deviations[0] * deviations.cwiseInverse()).asDiagonal() * axes.transpose();
    match.weight = kDistributionWeight;
  }
  return match;
}

}  // namespace lidarena::odometry::arena_lo
