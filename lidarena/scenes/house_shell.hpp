// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "lidarena/scenes/house_plan.hpp"

namespace lidarena::scenes {

/// A straight wall along x (axis 0) or y (axis 1), from the floor to `top`.
struct Wall {
  int axis;
  double line;  ///< the other coordinate of its center line
  double from, to;
  double top;
};

/// The walls between and around the rooms, each as high as the higher room beside it. Adjoining
/// sections on one line with equal height form one wall.
std::vector<Wall> plan_walls(const HousePlan& plan);

/// Floor, ceilings, walls with their openings, door trims, window frames and panes.
world::TriangleMesh build_shell(const HousePlan& plan, const HouseConfig& config);

}  // namespace lidarena::scenes
