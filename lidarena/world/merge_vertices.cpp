// SPDX-License-Identifier: BSD-3-Clause
#include <tsl/robin_map.h>

#include <array>
#include <bit>

#include "lidarena/world/triangle_mesh.hpp"

namespace lidarena::world {

using Eigen::Vector3d;

namespace {

struct BitsHash {
  std::size_t operator()(const std::array<double, 3>& v) const {
    std::uint64_t hash = 1469598103934665603U;  // FNV-1a applied to 64-bit words
    for (const double x : v) {
      hash = (hash ^ std::bit_cast<std::uint64_t>(x + 0.0)) * 1099511628211U;  // -0 + 0 is +0
      hash ^= hash >> 29U;
    }
    return hash;
  }
};

}  // namespace

void merge_vertices(TriangleMesh& mesh) {
  tsl::robin_map<std::array<double, 3>, std::uint32_t, BitsHash> index;
  std::vector<Vector3d> vertices;
  for (Triangle& triangle : mesh.triangles) {
    for (std::uint32_t& corner : triangle) {
      const Vector3d& v = mesh.vertices[corner];
      const auto [entry, is_new] =
          index.try_emplace({v.x(), v.y(), v.z()}, static_cast<std::uint32_t>(vertices.size()));
      if (is_new) vertices.push_back(v);
      corner = entry->second;
    }
  }
  mesh.vertices = std::move(vertices);
}

}  // namespace lidarena::world
