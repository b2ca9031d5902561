// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/report/simplified_mesh.hpp"

#include <array>
#include <cmath>
#include <map>

namespace lidarena::report {
namespace {

constexpr double kFirstCells = 512.0;  // cells along the mesh's diagonal in the first try

world::TriangleMesh clustered(const world::TriangleMesh& mesh, double cell) {
  world::TriangleMesh coarse;
  std::map<std::array<long, 3>, std::uint32_t> index_of;
  std::vector<std::uint32_t> moved;
  moved.reserve(mesh.vertices.size());
  for (const Eigen::Vector3d& v : mesh.vertices) {
    const std::array<long, 3> key{std::lround(v.x() / cell), std::lround(v.y() / cell),
                                  std::lround(v.z() / cell)};
    const auto [found, is_new] =
        index_of.try_emplace(key, static_cast<std::uint32_t>(coarse.vertices.size()));
    if (is_new) coarse.vertices.push_back(v);
    moved.push_back(found->second);
  }
  for (const world::Triangle& t : mesh.triangles) {
    const world::Triangle corners{moved[t[0]], moved[t[1]], moved[t[2]]};
    if (corners[0] == corners[1] || corners[1] == corners[2] || corners[2] == corners[0]) continue;
    coarse.triangles.push_back(corners);
  }
  return coarse;
}

}  // namespace

world::TriangleMesh simplified(const world::TriangleMesh& mesh, std::size_t max_triangles) {
  world::TriangleMesh coarse = mesh;
  double cell = mesh.triangles.empty() ? 1.0 : mesh.bounds().diagonal().norm() / kFirstCells;
  for (; coarse.triangles.size() > max_triangles; cell *= 2.0) coarse = clustered(mesh, cell);
  return coarse;
}

}  // namespace lidarena::report
