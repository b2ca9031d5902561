// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>

#include "lidarena/base/parallel.hpp"
#include "lidarena/world/world.hpp"

namespace lidarena::flight {

/// The most enclosed point of a grid over the mesh's bounding box: the one from which the most of
/// 64 evenly distributed directions end at a surface; of equals the one farthest from surfaces (up
/// to 1 m), then the first. Only points that keep `clearance` (m) and have a surface below them are
/// considered. Empty when there is none.
std::optional<Eigen::Vector3d> most_enclosed_place(const world::World& world, double clearance,
                                                   const Parallel& parallel);

}  // namespace lidarena::flight
