// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "lidarena/base/parallel.hpp"
#include "lidarena/base/pose.hpp"
#include "lidarena/evaluation/morton_order.hpp"
#include "lidarena/world/world.hpp"

namespace lidarena {

/// Where a point of a map lies against the mesh.
struct PointScore {
  double distance = 0.0;        ///< m, to the nearest triangle
  Eigen::Vector3f foot_offset;  ///< m, from the mesh's center to the nearest point of the surface
  float height = 0.0F;          ///< m above the nearest triangle's plane, on its normal's side
  std::uint32_t triangle = 0;   ///< the nearest
};

/// Center of the mesh's box: what PointScore::foot_offset counts from, so that a mesh far from the
/// origin costs no precision.
Eigen::Vector3d center_of(const World& world);

/// One score for each entry of `order` (of `map`), the map moved by `mesh_from_map`.
std::vector<PointScore> score_points(std::span<const Eigen::Vector3f> map, const MortonOrder& order,
                                     const Pose& mesh_from_map, const World& world,
                                     const Parallel& parallel);

}  // namespace lidarena
