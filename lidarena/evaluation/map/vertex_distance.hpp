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
#include "lidarena/map/kd_tree.hpp"
#include "lidarena/results/map_metrics.hpp"
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

using results::VertexDistance;

/// The vertices of the subdivided mesh in a k-d tree. Stays empty, and gives a refusal, for a mesh
/// that needs more than `max_vertices`.
class SubdividedMesh {
 public:
  explicit SubdividedMesh(const world::World& world, double edge = VertexDistance::kEdge_m,
                          std::uint64_t max_vertices = VertexDistance::kMaxVertices);

  /// Distances of the points of `order` (of `map`), moved by `mesh_from_map`, to their exact
  /// nearest vertices; `scores` are the scores of these points. Points beyond kFarEdges count with
  /// their distance to the surface. Bit-identical for any number of threads.
  VertexDistance distance_of(std::span<const Eigen::Vector3f> map, const MortonOrder& order,
                             std::span<const PointScore> scores, const Pose& mesh_from_map,
                             const Parallel& parallel) const;

 private:
  VertexDistance none_;  ///< without distances: number of vertices, refusal
  Eigen::Vector3d origin_;
  map::KdTree tree_;
};

}  // namespace lidarena::evaluation
