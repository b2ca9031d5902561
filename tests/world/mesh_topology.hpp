// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <numeric>
#include <unordered_map>
#include <vector>

#include "lidarena/world/triangle_mesh.hpp"

namespace lidarena::world::testing {

/// Topological properties of a mesh, from its triangles' vertex indices; every vertex must be used.
struct Topology {
  std::size_t open_edges = 0;  ///< directed edges whose opposite is missing or that occur twice
  std::size_t pinched_vertices = 0;  ///< vertices whose triangles form more than one fan
  std::size_t components = 0;
  long euler = 0;  ///< vertices - edges + triangles; 2 - 2 * genus for one closed surface
};

/// Root of i in a disjoint-set forest, with path halving.
inline std::uint32_t root(std::vector<std::uint32_t>& parent, std::uint32_t i) {
  while (parent[i] != i) i = parent[i] = parent[parent[i]];
  return i;
}

inline Topology topology(const TriangleMesh& mesh) {
  Topology result;
  const auto key = [](std::uint32_t a, std::uint32_t b) {
    return static_cast<std::uint64_t>(a) << 32U | b;
  };
  std::unordered_map<std::uint64_t, int> edges;
  std::unordered_map<std::uint64_t, std::uint32_t> next;  // next vertex in the ring around a vertex
  std::vector<std::uint32_t> degree(mesh.vertices.size(), 0);
  std::vector<std::uint32_t> parent(mesh.vertices.size());
  std::iota(parent.begin(), parent.end(), 0U);
  for (const Triangle& t : mesh.triangles) {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = t[k];
      const std::uint32_t b = t[(k + 1) % 3];
      ++edges[key(a, b)];
      next[key(a, b)] = t[(k + 2) % 3];
      ++degree[a];
      parent[root(parent, a)] = root(parent, b);
    }
  }
  for (const auto& [edge, count] : edges) {
    const auto opposite = edges.find(edge << 32U | edge >> 32U);
    if (count != 1 || opposite == edges.end()) ++result.open_edges;
  }
  for (const auto& [edge, neighbor] : next) {
    const auto a = static_cast<std::uint32_t>(edge >> 32U);
    if (degree[a] == 0) continue;  // the ring was already traversed
    const auto first = static_cast<std::uint32_t>(edge);
    std::uint32_t steps = 0;
    std::uint32_t at = first;
    do {
      const auto found = next.find(key(a, at));
      if (found == next.end()) break;
      at = found->second;
      ++steps;
    } while (at != first && steps <= degree[a]);
    if (steps != degree[a]) ++result.pinched_vertices;
    degree[a] = 0;
  }
  for (std::uint32_t i = 0; i < parent.size(); ++i) result.components += parent[i] == i ? 1 : 0;
  result.euler = static_cast<long>(mesh.vertices.size()) - static_cast<long>(edges.size() / 2) +
                 static_cast<long>(mesh.triangles.size());
  return result;
}

}  // namespace lidarena::world::testing
