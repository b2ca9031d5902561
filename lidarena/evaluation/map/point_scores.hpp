// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "lidarena/base/parallel.hpp"
#include "lidarena/base/pose.hpp"
#include "lidarena/evaluation/map/morton_order.hpp"
#include "lidarena/world/world.hpp"

namespace lidarena::evaluation {

/// Position of a map point relative to the mesh.
struct PointScore {
  double distance = 0.0;        ///< m, to the nearest triangle
  Eigen::Vector3f foot_offset;  ///< m, from the mesh's center to the nearest point of the surface
  float height = 0.0F;          ///< m above the nearest triangle's plane, on its normal's side
  std::uint32_t triangle = 0;   ///< index of the nearest triangle
};

/// Center of the mesh's bounding box. Offsets (PointScore::foot_offset) are relative to it, so that
/// single precision suffices for a mesh far from the origin.
Eigen::Vector3d center_of(const world::World& world);

/// One score per entry of `order` (of `map`), after moving the map by `mesh_from_map`.
std::vector<PointScore> score_points(std::span<const Eigen::Vector3f> map, const MortonOrder& order,
                                     const Pose& mesh_from_map, const world::World& world,
                                     const Parallel& parallel);

}  // namespace lidarena::evaluation
