// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "lidarena/base/parallel.hpp"
#include "lidarena/base/pose.hpp"
#include "lidarena/evaluation/map/map_error.hpp"
#include "lidarena/evaluation/map/morton_order.hpp"
#include "lidarena/evaluation/map/point_scores.hpp"
#include "lidarena/world/triangle_mesh.hpp"
#include "lidarena/world/world.hpp"

namespace lidarena::evaluation {

/// Number of vertices that subdivided_vertices() returns.
std::uint64_t count_subdivided(const world::TriangleMesh& mesh, double edge);

/// Vertices of the mesh (m, relative to `origin`) with each triangle divided into n^2 equal ones, n
/// the smallest number for which none of its edges is longer than `edge` (m, above 0). The mesh's
/// own vertices are listed once, new ones on an edge once for each adjacent triangle.
std::vector<Eigen::Vector3f> subdivided_vertices(const world::TriangleMesh& mesh, double edge,
                                                 const Eigen::Vector3d& origin);

/// Distances of a map's points to the nearest *vertex* of the subdivided mesh, as the paper
/// computes them (section 3); only for comparison with its tables. A point that lies on the surface
/// has a distance of up to 0.58 edges.
struct VertexDistance {
  static constexpr double kEdge_m = 0.05;
  static constexpr std::uint64_t kMaxVertices = 20'000'000;  ///< needs about 1.4 GB temporarily
  /// Points of a failed map lie far outside the mesh, where thousands of vertices are almost as
  /// near as the nearest and the search is slow. Beyond this many edges (1 m) the distance to the
  /// surface is used instead. It is too small by no more than 1/120 edge (0.42 mm), because a
  /// vertex lies within 0.58 edges of the nearest surface point.
  static constexpr double kFarEdges = 20.0;
  double edge_m = kEdge_m;  ///< maximum edge length of the subdivided mesh
  std::uint64_t vertices = 0;
  std::string refusal;  ///< empty when `error` is valid
  MapError error;
};

/// Distances of the points of `order` (of `map`), moved by `mesh_from_map`, to their exact nearest
/// vertices (k-d tree); `scores` are the scores of these points. Points beyond kFarEdges count with
/// their distance to the surface. Refused for meshes that need more than `max_vertices` vertices.
/// Bit-identical for any number of threads.
VertexDistance vertex_distance(std::span<const Eigen::Vector3f> map, const MortonOrder& order,
                               std::span<const PointScore> scores, const Pose& mesh_from_map,
                               const world::World& world, const Parallel& parallel,
                               double edge = VertexDistance::kEdge_m,
                               std::uint64_t max_vertices = VertexDistance::kMaxVertices);

}  // namespace lidarena::evaluation
