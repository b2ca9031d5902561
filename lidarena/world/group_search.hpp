// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "lidarena/world/triangle_frame.hpp"
#include "lidarena/world/world.hpp"

namespace lidarena::world {

/// A triangle and its distance (m) to the query point.
struct NearTriangle {
  double distance;
  std::uint32_t index;
};

/// A spatial tree over the triangles of a mesh.
class TriangleTree {
 public:
  virtual ~TriangleTree() = default;
  /// See World::closest_point. `guess`: a triangle that is probably near, or Hit::kNone.
  virtual ClosestPoint nearest(const Eigen::Vector3d& point, double max_distance,
                               std::uint32_t guess) const = 0;
  /// Writes all triangles within `radius` of `center` to `found`. Returns false when there are more
  /// than `limit`; `found` is then unspecified.
  virtual bool within(const Eigen::Vector3d& center, double radius, std::size_t limit,
                      std::vector<NearTriangle>& found) const = 0;
};

/// Nearest points of a mesh for a list of points in which consecutive points are near each other.
/// The tree is searched once per group of points; each point of the group is then compared with the
/// few triangles found, nearest first. The results are bit-identical to one search per point.
class GroupSearch {
 public:
  GroupSearch(const TriangleMesh& mesh, const TriangleTree& tree, double group_size,
              double max_distance)
      : mesh_(mesh), tree_(tree), group_size_(group_size), max_distance_(max_distance) {}

  void run(std::span<const Eigen::Vector3d> points, std::span<ClosestPoint> out);

 private:
  using Points = std::span<const Eigen::Vector3d>;
  using Results = std::span<ClosestPoint>;

  void one_by_one(Points points, Results out);
  void search_group(Points points, Results out);
  bool gather(const Eigen::Vector3d& center, double radius);
  ClosestPoint choose(const Eigen::Vector3d& point, double offset, double rounding) const;

  const TriangleMesh& mesh_;
  const TriangleTree& tree_;
  double group_size_;  ///< m, largest edge of the box around a group
  double max_distance_;
  std::uint32_t last_ = Hit::kNone;  ///< triangle found by the previous search, used as a guess
  std::vector<NearTriangle> found_;  ///< around the group, nearest to its center first
  std::vector<TriangleFrame> frames_;
};

}  // namespace lidarena::world
