// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "lidarena/world/triangle_mesh.hpp"

namespace lidarena {

/// A world before its ray caster is built: the mesh, and ways to fly where the maker knows them.
struct WorldModel {
  std::string name;
  TriangleMesh mesh;
  /// Polylines through free space (m); worlds from files have none.
  std::vector<std::vector<Eigen::Vector3d>> routes;
};

}  // namespace lidarena
