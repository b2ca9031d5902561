// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>

#include "lidarena/base/parallel.hpp"
#include "lidarena/world/world.hpp"

namespace lidarena {

/// The place, of a grid over the mesh's box, that is most enclosed: from where the most of 64 even
/// directions end at a surface; of equals the one with the most room (up to 1 m), then the first.
/// Only places that keep `clearance` and have a floor below them count.
std::optional<Eigen::Vector3d> most_enclosed_place(const World& world, double clearance,
                                                   const Parallel& parallel);

}  // namespace lidarena
