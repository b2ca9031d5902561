// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "lidarena/world/triangle_frame.hpp"
#include "lidarena/world/world.hpp"

namespace lidarena {

/// A triangle and its distance (m) to the point that was asked about.
struct NearTriangle {
  double distance;
  std::uint32_t index;
};

/// A spatial tree over the triangles of a mesh.
class TriangleTree {
 public:
  virtual ~TriangleTree() = default;
  /// See World::closest_point; `guess` is a triangle that may be near (or Hit::kNone).
  virtual ClosestPoint nearest(const Eigen::Vector3d& point, double max_distance,
                               std::uint32_t guess) const = 0;
  /// All triangles within `radius` of `center`; false, with `found` in any state, when there are
  /// more than `limit`.
  virtual bool within(const Eigen::Vector3d& center, double radius, std::size_t limit,
                      std::vector<NearTriangle>& found) const = 0;
};

/// Nearest points of a mesh for many points of which neighbors in the list are neighbors in
/// space: the tree is walked once for a group of them, and each then looks at the few triangles
/// found, nearest first. The answers are those of one search a point, bit for bit.
class GroupSearch {
 public:
  GroupSearch(const TriangleMesh& mesh, const TriangleTree& tree, double group_size,
              double max_distance)
      : mesh_(mesh), tree_(tree), group_size_(group_size), max_distance_(max_distance) {}

  void run(std::span<const Eigen::Vector3d> points, std::span<ClosestPoint> out);

 private:
  using Points = std::span<const Eigen::Vector3d>;
  using Answers = std::span<ClosestPoint>;

  void one_by_one(Points points, Answers out);
  void together(Points points, Answers out);
  bool gather(const Eigen::Vector3d& center, double radius);
  ClosestPoint choose(const Eigen::Vector3d& point, double offset, double rounding) const;

  const TriangleMesh& mesh_;
  const TriangleTree& tree_;
  double group_size_;  ///< m, largest edge of the box around a group
  double max_distance_;
  std::uint32_t last_ = Hit::kNone;  ///< what the last search found: a good first guess
  std::vector<NearTriangle> found_;  ///< around the group, nearest to its center first
  std::vector<TriangleFrame> frames_;
};

}  // namespace lidarena
