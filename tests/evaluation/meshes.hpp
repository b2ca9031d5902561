// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "lidarena/world/triangle_mesh.hpp"

/// Surfaces to which distances have a closed form.
namespace lidarena::evaluation::meshes {

/// Square in z = 0, centered, as two triangles.
inline world::TriangleMesh plane(double edge) {
  const double h = 0.5 * edge;
  world::TriangleMesh mesh;
  mesh.vertices = {{-h, -h, 0}, {h, -h, 0}, {h, h, 0}, {-h, h, 0}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  return mesh;
}

/// Box around the origin, two triangles per face.
inline world::TriangleMesh box(const Eigen::Vector3d& half) {
  world::TriangleMesh mesh;
  for (int i = 0; i < 8; ++i) {
    mesh.vertices.emplace_back((i & 1) != 0 ? half.x() : -half.x(),
                               (i & 2) != 0 ? half.y() : -half.y(),
                               (i & 4) != 0 ? half.z() : -half.z());
  }
  mesh.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                    {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  return mesh;
}

}  // namespace lidarena::evaluation::meshes
