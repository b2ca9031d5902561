// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <limits>

namespace lidarena::map {

/// A point of a map (m) and its squared distance (m^2) from the query.
struct Neighbor {
  Eigen::Vector3f point = Eigen::Vector3f::Zero();
  float squared_distance = std::numeric_limits<float>::infinity();
};

/// The points of `neighbors` as columns.
template <std::size_t N>
Eigen::Matrix<double, 3, static_cast<int>(N)> columns_of(const std::array<Neighbor, N>& neighbors) {
  Eigen::Matrix<double, 3, static_cast<int>(N)> columns;
  for (std::size_t i = 0; i < N; ++i)
    columns.col(static_cast<Eigen::Index>(i)) = neighbors[i].point.template cast<double>();
  return columns;
}

}  // namespace lidarena::map
