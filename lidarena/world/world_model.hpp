// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "lidarena/world/mover_config.hpp"
#include "lidarena/world/triangle_mesh.hpp"

namespace lidarena::world {

/// A world without its ray caster: the mesh, and flight routes if its generator provides them.
struct WorldModel {
  std::string name;
  TriangleMesh mesh;
  /// Polylines through free space (m); worlds from files have none.
  std::vector<std::vector<Eigen::Vector3d>> routes;
  std::vector<MoverConfig> movers{};  ///< bodies that move, by their names
  int people = 0;                     ///< number of people to be drawn beside, see draw_people()
};

}  // namespace lidarena::world
