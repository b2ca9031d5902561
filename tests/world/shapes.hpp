// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "lidarena/base/random.hpp"
#include "lidarena/world/triangle_mesh.hpp"

/// Meshes small enough to reason about.
namespace lidarena::world::testing {

/// The box [low, high]: 8 vertices, 12 triangles, normals outward.
inline TriangleMesh box_mesh(const Eigen::Vector3d& low, const Eigen::Vector3d& high) {
  TriangleMesh mesh;
  for (unsigned i = 0; i < 8; ++i) {
    mesh.vertices.emplace_back((i & 1U) != 0 ? high.x() : low.x(),
                               (i & 2U) != 0 ? high.y() : low.y(),
                               (i & 4U) != 0 ? high.z() : low.z());
  }
  mesh.triangles = {{0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}, {0, 1, 5}, {0, 5, 4},
                    {2, 6, 7}, {2, 7, 3}, {0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}};
  return mesh;
}

inline Eigen::Vector3d random_point(SequentialRandom& random, double half_size) {
  const double x = random.uniform(-half_size, half_size);
  const double y = random.uniform(-half_size, half_size);
  return {x, y, random.uniform(-half_size, half_size)};
}

inline Eigen::Vector3d random_direction(SequentialRandom& random) {
  const double x = random.normal();
  const double y = random.normal();
  return Eigen::Vector3d(x, y, random.normal()).normalized();
}

/// `count` random triangles with edges of about 1 m in the cube [-half_size, half_size]^3.
inline TriangleMesh triangle_soup(std::size_t count, double half_size, std::uint64_t seed) {
  SequentialRandom random(seed);
  TriangleMesh mesh;
  for (std::uint32_t i = 0; i < count; ++i) {
    const Eigen::Vector3d middle = random_point(random, half_size);
    for (int corner = 0; corner < 3; ++corner) {
      mesh.vertices.push_back(middle + random_point(random, 0.7));
    }
    mesh.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
  }
  return mesh;
}

/// Signed volume: a sixth of the sum of a . (b x c); positive when normals point outward.
inline double signed_volume(const TriangleMesh& mesh) {
  double six = 0.0;
  for (const auto& [a, b, c] : mesh.triangles) {
    six += mesh.vertices[a].dot(mesh.vertices[b].cross(mesh.vertices[c]));
  }
  return six / 6.0;
}

}  // namespace lidarena::world::testing
