// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/evaluation/map/vertex_distance.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "lidarena/evaluation/map/point_scores.hpp"

namespace lidarena::evaluation {

using Eigen::Vector3d;
using Eigen::Vector3f;

namespace {

/// Points of a failed map lie far outside the mesh, where thousands of vertices are almost as near
/// as the nearest and the search is slow. Beyond this many edges (1 m) the distance to the surface
/// is used instead. It is too small by no more than 1/120 edge (0.42 mm), because a vertex lies
/// within 0.58 edges of the nearest surface point.
constexpr double kFarEdges = 20.0;

/// Number of pieces of each edge of a triangle; a double, because it may exceed every integer type.
double pieces_of(const world::TriangleMesh& mesh, const world::Triangle& triangle, double edge) {
  double longest = 0.0;
  for (std::size_t k = 0; k < 3; ++k) {
    const Vector3d side = mesh.vertices[triangle[(k + 1) % 3]] - mesh.vertices[triangle[k]];
    longest = std::max(longest, side.norm());
  }
  return std::max(1.0, std::ceil(longest / edge));
}

std::vector<bool> used_vertices(const world::TriangleMesh& mesh) {
  std::vector<bool> used(mesh.vertices.size(), false);
  for (const world::Triangle& triangle : mesh.triangles) {
    for (const std::uint32_t corner : triangle) used[corner] = true;
  }
  return used;
}

}  // namespace

std::uint64_t count_subdivided(const world::TriangleMesh& mesh, double edge) {
  const std::vector<bool> used = used_vertices(mesh);
  auto count = static_cast<double>(std::count(used.begin(), used.end(), true));
  for (const world::Triangle& triangle : mesh.triangles) {
    const double n = pieces_of(mesh, triangle, edge);
    count += 0.5 * (n + 1.0) * (n + 2.0) - 3.0;  // without its corners
  }
  constexpr double kMaxCount = 1e18;
  return static_cast<std::uint64_t>(std::min(count, kMaxCount));
}

std::vector<Vector3f> subdivided_vertices(const world::TriangleMesh& mesh, double edge,
                                          const Vector3d& origin) {
  std::vector<Vector3f> vertices;
  vertices.reserve(count_subdivided(mesh, edge));
  const std::vector<bool> used = used_vertices(mesh);
  for (std::size_t v = 0; v < used.size(); ++v) {
    if (used[v]) vertices.emplace_back((mesh.vertices[v] - origin).cast<float>());
  }
  for (const world::Triangle& triangle : mesh.triangles) {
    const auto n = static_cast<int>(pieces_of(mesh, triangle, edge));
    const Vector3d a = mesh.vertices[triangle[0]] - origin;
    const Vector3d ab = (mesh.vertices[triangle[1]] - mesh.vertices[triangle[0]]) / n;
    const Vector3d ac = (mesh.vertices[triangle[2]] - mesh.vertices[triangle[0]]) / n;
    for (int i = 0; i <= n; ++i) {
      for (int j = 0; i + j <= n; ++j) {
        const bool corner = std::max({i, j, n - i - j}) == n;
        if (!corner) vertices.emplace_back((a + i * ab + j * ac).cast<float>());
      }
    }
  }
  return vertices;
}

SubdividedMesh::SubdividedMesh(const world::World& world, double edge, std::uint64_t max_vertices)
    : origin_(center_of(world)) {
  none_.edge_m = edge;
  none_.vertices = count_subdivided(world.mesh(), edge);
  if (none_.vertices <= max_vertices) {
    tree_.build(subdivided_vertices(world.mesh(), edge, origin_));
    return;
  }
  none_.refused = fmt::format(
      "the mesh subdivided to {:g} cm has {:.3g} million vertices, more than the limit of {:g} "
      "million",
      100.0 * edge, 1e-6 * static_cast<double>(none_.vertices),
      1e-6 * static_cast<double>(max_vertices));
}

VertexDistance SubdividedMesh::distance_of(std::span<const Vector3f> map, const MortonOrder& order,
                                           std::span<const PointScore> scores,
                                           const Pose& mesh_from_map,
                                           const Parallel& parallel) const {
  VertexDistance result = none_;
  if (result.refused) return result;
  const double edge = result.edge_m;
  std::vector<double> distances(map.size(), std::numeric_limits<double>::quiet_NaN());
  constexpr std::size_t kGrain = 4096;
  parallel.for_each(order.entries.size(), kGrain, [&](std::size_t k) {
    const std::uint32_t index = order.entries[k].index;
    const double to_surface = scores[k].distance;
    if (to_surface > kFarEdges * edge) {
      distances[index] = to_surface;
      return;
    }
    const Vector3d moved = mesh_from_map * map[index].cast<double>();
    const auto bound = static_cast<float>(to_surface + edge);  // a vertex lies within 0.58 edges
    map::Neighbor nearest;
    tree_.nearest((moved - origin_).cast<float>(), std::span(&nearest, 1), bound);
    distances[index] = std::sqrt(double{nearest.squared_distance});
  });
  const MapError error = summarize_distances(distances);
  result.points = error.points;
  if (error.points == 0) return result;
  result.rmse_m = error.distance_m.rmse;
  result.rmse_inliers_m = error.rmse_inliers_m;
  result.median_m = error.distance_m.median;
  result.outliers_percent = error.outliers_percent;
  return result;
}

}  // namespace lidarena::evaluation
