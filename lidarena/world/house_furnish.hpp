// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "lidarena/world/house_plan.hpp"

namespace lidarena {

/// A piece of furniture where it stands, in the world frame.
struct PlacedObject {
  std::string kind;
  TriangleMesh mesh;
  Eigen::AlignedBox3d box;
  double top = 0;  ///< height of its table top; 0: none
};

/// Furnishes every room. Pieces are tried at random places until one is free: inside the room,
/// clear of other pieces, doors and (where they are tall) windows, and 0.5 m from the route. What
/// finds no place in 300 tries is left out.
std::vector<PlacedObject> furnish_house(const HousePlan& plan, const HouseConfig& config,
                                        std::uint64_t seed);

}  // namespace lidarena
