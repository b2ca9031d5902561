// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>

#include "lidarena/world/triangle_mesh.hpp"

namespace lidarena::flight::test_scenes {

/// A closed box of twelve triangles.
inline world::TriangleMesh box(const Eigen::Vector3d& low, const Eigen::Vector3d& high) {
  world::TriangleMesh mesh;
  for (int i = 0; i < 8; ++i) {
    mesh.vertices.emplace_back((i & 1) != 0 ? high.x() : low.x(), (i & 2) != 0 ? high.y() : low.y(),
                               (i & 4) != 0 ? high.z() : low.z());
  }
  constexpr std::array<std::array<std::uint32_t, 4>, 6> kFaces{
      {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}}};
  for (const auto& f : kFaces) {
    mesh.triangles.push_back({f[0], f[1], f[2]});
    mesh.triangles.push_back({f[0], f[2], f[3]});
  }
  return mesh;
}

/// Two walls in the plane x = 0 with a door of 0.9 m width between them: |y| < 0.45.
inline world::TriangleMesh wall_with_door() {
  world::TriangleMesh mesh = box({-0.05, 0.45, 0.0}, {0.05, 3.0, 2.5});
  mesh.append(box({-0.05, -3.0, 0.0}, {0.05, -0.45, 2.5}));
  return mesh;
}

}  // namespace lidarena::flight::test_scenes
