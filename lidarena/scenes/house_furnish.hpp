// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "lidarena/scenes/house_plan.hpp"

namespace lidarena::scenes {

/// A placed piece of furniture, in the world frame.
struct PlacedObject {
  std::string kind;
  world::TriangleMesh mesh;
  Eigen::AlignedBox3d box;
  double top = 0;  ///< height of its table top; 0: none
};

/// Furnishes every room. Each piece is tried at random places until one is free: inside the room,
/// without overlap with other pieces, doors and (if tall) windows, and 0.5 m from the route. A
/// piece without a free place after 300 tries is left out.
std::vector<PlacedObject> furnish_house(const HousePlan& plan, const HouseConfig& config,
                                        std::uint64_t seed);

}  // namespace lidarena::scenes
