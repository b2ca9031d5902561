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
#include "lidarena/evaluation/map_error.hpp"
#include "lidarena/evaluation/morton_order.hpp"
#include "lidarena/evaluation/point_scores.hpp"
#include "lidarena/world/triangle_mesh.hpp"
#include "lidarena/world/world.hpp"

namespace lidarena {

/// How many vertices subdivided_vertices() gives.
std::uint64_t count_subdivided(const TriangleMesh& mesh, double edge);

/// Vertices of the mesh with each triangle cut into n^2 alike, n the least for which none of its
/// edges is longer than `edge` (m, above 0), less `origin`. The mesh's own vertices stand once, new
/// ones on an edge once for each of its triangles.
std::vector<Eigen::Vector3f> subdivided_vertices(const TriangleMesh& mesh, double edge,
                                                 const Eigen::Vector3d& origin);

/// Distances of a map's points to the nearest *vertex* of the subdivided mesh, as the paper takes
/// them (section 3), for comparison with its tables alone: a point on the surface is off by up to
/// 0.58 edges.
struct VertexDistance {
  static constexpr double kEdge_m = 0.05;
  static constexpr std::uint64_t kMostVertices = 20'000'000;  ///< about 1.4 GB while it lasts
  /// A lost map's points lie far outside, where thousands of vertices are almost as near as the
  /// nearest. From so many edges on (1 m) the distance to the surface stands for that to the vertex:
  /// short by at most 1/120 edge (0.42 mm), for a vertex is within 0.58 edges of where that meets it.
  static constexpr double kFarEdges = 20.0;
  double edge_m = kEdge_m;                                    ///< no edge is longer
  std::uint64_t vertices = 0;
  std::string refusal;  ///< empty when `error` holds
  MapError error;
};

/// Exact nearest vertices (k-d tree) of the points of `order` (of `map`), moved by `mesh_from_map`;
/// `scores` are theirs there. Points beyond kFarEdges count with their distance to the surface.
/// Refused for meshes that need more than `most` vertices. The same bits on any number of threads.
VertexDistance vertex_distance(std::span<const Eigen::Vector3f> map, const MortonOrder& order,
                               std::span<const PointScore> scores, const Pose& mesh_from_map,
                               const World& world, const Parallel& parallel,
                               double edge = VertexDistance::kEdge_m,
                               std::uint64_t most = VertexDistance::kMostVertices);

}  // namespace lidarena
