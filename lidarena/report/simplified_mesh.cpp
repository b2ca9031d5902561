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

std::vector<Eigen::Vector3f> points_on(const world::TriangleMesh& mesh, std::size_t count) {
  // Within triangles by the sequence of M. Roberts (2018), "The unreasonable effectiveness of
  // quasirandom sequences", folded into the triangle.
  constexpr double kPlastic = 1.32471795724474602596;
  const double step = mesh.area() / static_cast<double>(count);
  std::vector<Eigen::Vector3f> points;
  double area = 0.0, next = 0.5 * step;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    area += 0.5 * mesh.cross(t).norm();
    const world::Triangle& corners = mesh.triangles[t];
    const Eigen::Vector3d& a = mesh.vertices[corners[0]];
    for (; next < area && points.size() < count; next += step) {
      const auto k = static_cast<double>(points.size() + 1);
      double u = std::fmod(k / kPlastic, 1.0), v = std::fmod(k / (kPlastic * kPlastic), 1.0);
      if (u + v > 1.0) {
        u = 1.0 - u;
        v = 1.0 - v;
      }
      points.push_back(
          (a + u * (mesh.vertices[corners[1]] - a) + v * (mesh.vertices[corners[2]] - a))
              .cast<float>());
    }
  }
  return points;
}

}  // namespace lidarena::report
