// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/map/cell_insertion.hpp"

#include <algorithm>

namespace lidarena::map {

CellInsertion cell_insertion(const Eigen::Vector3f& point, std::span<const Neighbor> neighbors,
                             float voxel) {
  if (neighbors.empty()) return CellInsertion::kThinned;
  const Eigen::Vector3f center = ((point / voxel).array().floor() + 0.5F) * voxel;
  const Eigen::Vector3f away = (neighbors.front().point - center).cwiseAbs();
  if ((away.array() > 0.5F * voxel).all()) return CellInsertion::kPlain;
  const float own = (point - center).squaredNorm();
  const bool is_beaten = std::any_of(
      neighbors.begin(), neighbors.end(),
      [&](const Neighbor& other) { return (other.point - center).squaredNorm() < own; });
  return is_beaten ? CellInsertion::kNone : CellInsertion::kThinned;
}

}  // namespace lidarena::map
