// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/map/neighborhood.hpp"

#include <Eigen/Eigenvalues>

namespace lidarena::map {

Neighborhood describe(std::span<const Neighbor> neighbors) {
  const Eigen::Vector3f& origin = neighbors.front().point;
  Eigen::Vector3f sum = Eigen::Vector3f::Zero();
  Eigen::Matrix3f squares = Eigen::Matrix3f::Zero();
  for (const Neighbor& neighbor : neighbors) {
    const Eigen::Vector3f d = neighbor.point - origin;  // small, so float precision suffices
    sum += d;
    squares += d * d.transpose();
  }
  const auto count = static_cast<double>(neighbors.size());
  const Eigen::Vector3d mean = sum.cast<double>() / count;
  const Eigen::Matrix3d covariance = squares.cast<double>() / count - mean * mean.transpose();
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
  solver.computeDirect(covariance);

  Neighborhood result{mean + origin.cast<double>(), solver.eigenvectors().col(0)};
  const Eigen::Vector3d s = solver.eigenvalues().cwiseMax(0.0).cwiseSqrt();
  if (s[2] > 0.0) result.planarity = (s[1] - s[0]) / s[2];
  return result;
}

}  // namespace lidarena::map
