// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "tests/flight/flight_scenes.hpp"

namespace lidarena::flight::test_scenes {

/// Two rooms of 4 x 4 x 2.5 m, x in [0, 4] and [4.1, 8.1], y in [0, 4], z in [0, 2.5]. Walls, floor
/// and ceiling are 0.1 m thick; a door between the rooms is 0.9 m wide, 2 m high and centered at
/// y = 1.03. Built of adjoining solid boxes: the faces between two boxes are not visible.
inline world::TriangleMesh two_rooms() {
  world::TriangleMesh mesh = box({-0.1, -0.1, -0.1}, {8.2, 4.1, 0});  // floor
  mesh.append(box({-0.1, -0.1, 2.5}, {8.2, 4.1, 2.6}));               // ceiling
  mesh.append(box({-0.1, -0.1, 0}, {0, 4.1, 2.5}));
  mesh.append(box({8.1, -0.1, 0}, {8.2, 4.1, 2.5}));
  mesh.append(box({0, -0.1, 0}, {8.1, 0, 2.5}));
  mesh.append(box({0, 4, 0}, {8.1, 4.1, 2.5}));
  mesh.append(box({4, 0, 0}, {4.1, 0.58, 2.5}));  // middle wall, on both sides of the door
  mesh.append(box({4, 1.48, 0}, {4.1, 4, 2.5}));
  mesh.append(box({4, 0.58, 2}, {4.1, 1.48, 2.5}));  // lintel
  return mesh;
}

/// Area of two_rooms() that faces the space inside, m^2.
inline double two_rooms_inner_area() {
  const double floors = 2 * (2 * 16.0);                // floor and ceiling of both rooms
  const double long_walls = 2 * (2 * 4 * 2.5);         // y = 0 and y = 4
  const double end_walls = 2 * (4 * 2.5);              // x = 0 and x = 8.1
  const double middle_wall = 2 * (4 * 2.5 - 0.9 * 2);  // both faces, minus the door
  const double door = 0.1 * (2 * 2 + 2 * 0.9);         // posts, lintel and sill
  return floors + long_walls + end_walls + middle_wall + door;
}

}  // namespace lidarena::flight::test_scenes
