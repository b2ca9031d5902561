// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <map>
#include <span>
#include <vector>

#include "lidarena/base/pose.hpp"
#include "lidarena/base/time.hpp"
#include "lidarena/map/kd_tree.hpp"
#include "lidarena/map/voxel_sums.hpp"

namespace lidarena::map {

/// When and where a keyframe was taken.
struct KeyframePlace {
  Time stamp{0};
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< m, world
};

/// Which keyframes make a submap.
struct SubmapExtent {
  double radius_m = 50.0;           ///< around the last keyframe
  double keyframe_spacing_m = 2.0;  ///< edge of the cells of each of which the oldest is chosen
  double recent_s = 10.0;           ///< all that are not older are chosen too
};

/// Sorted indices of the keyframes for the submap at `now` around `position` (m): of those within
/// the radius the oldest of each cell (so that drift does not accumulate) and the recent ones.
std::vector<std::uint32_t> surrounding(std::span<const KeyframePlace> keyframes,
                                       const Eigen::Vector3d& position, Time now,
                                       const SubmapExtent& extent);

/// Appends the points (m) of a keyframe to those of another frame, in single precision.
void append_placed(const Pose& frame_from_keyframe, std::span<const Eigen::Vector3f> points,
                   std::vector<Eigen::Vector3f>& out);

/// Averages in voxels of the points of selected keyframes, searchable. A new selection costs the
/// insertion and removal of the keyframes that differ, and building the search tree.
class Submap {
 public:
  /// `revision_of(keyframe)`: number of changes of its points or its pose so far.
  using RevisionOf = std::function<std::uint32_t(std::uint32_t keyframe)>;
  /// `placed(keyframe)`: its points in the world (m).
  using Placed = std::function<std::vector<Eigen::Vector3f>(std::uint32_t keyframe)>;

  explicit Submap(double voxel_size) : sums_(voxel_size) {}

  /// `chosen`: sorted indices of keyframes.
  void select(std::span<const std::uint32_t> chosen, const RevisionOf& revision_of,
              const Placed& placed);

  const KdTree& tree() const { return tree_; }
  std::size_t size() const { return tree_.size(); }
  std::uint64_t memory_bytes() const;

 private:
  /// What was inserted for a keyframe.
  struct Part {
    std::uint32_t revision = 0;
    std::vector<Eigen::Vector3f> points;  ///< world frame
  };

  std::map<std::uint32_t, Part> parts_;  ///< by keyframe
  VoxelSums sums_;
  KdTree tree_;
};

}  // namespace lidarena::map
