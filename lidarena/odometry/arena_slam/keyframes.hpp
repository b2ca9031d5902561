// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <map>
#include <vector>

#include "lidarena/base/pose.hpp"
#include "lidarena/base/time.hpp"
#include "lidarena/map/voxel_sums.hpp"
#include "lidarena/odometry/arena_slam/config.hpp"
#include "lidarena/odometry/arena_slam/features.hpp"
#include "lidarena/odometry/arena_slam/registration.hpp"

namespace lidarena::odometry::arena_slam {

/// A scan kept for the map.
struct Keyframe {
  Time stamp{0};
  Pose world_from_lidar = Pose::Identity();
  Features features;           ///< downsampled, LiDAR frame
  std::uint32_t revision = 0;  ///< number of changes of pose or features
};

/// Whether a scan at `stamp` and `world_from_lidar` should be a keyframe, given the last one.
bool is_keyframe(const Keyframe& last, Time stamp, const Pose& world_from_lidar,
                 const Config& config);

/// Averages the scans up to the next keyframe into the last one.
class KeyframeMerger {
 public:
  /// Starts a new keyframe with these features.
  void begin(const Features& features);
  /// Adds a scan. Returns whether the keyframe's features should be replaced by merged(): each time
  /// the number of scans has quadrupled, so that the map of a sensor at rest rarely changes.
  bool add(const Features& features, const Pose& keyframe_from_lidar, const Config& config);
  /// Average of all scans added so far.
  Features merged(const Config& config) const { return thinned(all_, config); }

 private:
  Features all_;
  int scans_ = 0;
};

/// Sorted indices of the keyframes for the submap at `now` around `position` (m): of those within
/// the radius the oldest of each cell (so that drift does not accumulate) and the recent ones.
std::vector<std::uint32_t> surrounding(const std::vector<Keyframe>& keyframes,
                                       const Eigen::Vector3d& position, Time now,
                                       const Config& config);

/// Map of the features of selected keyframes. A new selection costs the insertion and removal of
/// the keyframes that differ, and building the search trees.
class Submap {
 public:
  explicit Submap(const Config& config)
      : edges_(config.edge_voxel_size_m, config.grid_axes),
        surfaces_(config.surface_voxel_size_m, config.grid_axes) {}
  /// `chosen`: sorted indices of `keyframes`.
  void select(const std::vector<Keyframe>& keyframes, const std::vector<std::uint32_t>& chosen);
  const FeatureMap& map() const { return map_; }
  std::size_t size() const { return map_.edges.size() + map_.surfaces.size(); }
  std::uint64_t memory_bytes() const;

 private:
  /// What was inserted for a keyframe.
  struct Part {
    std::uint32_t revision = 0;
    Features placed;  ///< world frame
  };

  std::map<std::uint32_t, Part> parts_;  ///< by index of the keyframe
  map::VoxelSums edges_;
  map::VoxelSums surfaces_;
  FeatureMap map_;
};

}  // namespace lidarena::odometry::arena_slam
