// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <map>
#include <vector>

#include "lidarena/base/pose.hpp"
#include "lidarena/base/time.hpp"
#include "lidarena/map/voxel_sums.hpp"
#include "lidarena/odometry/lio_sam/config.hpp"
#include "lidarena/odometry/lio_sam/features.hpp"
#include "lidarena/odometry/lio_sam/registration.hpp"

namespace lidarena::lio_sam {

/// A scan that is kept.
struct Keyframe {
  Time stamp{0};
  Pose world_from_lidar = Pose::Identity();
  Features features;           ///< thinned, LiDAR frame
  std::uint32_t revision = 0;  ///< how often it has been moved or renewed
};

/// Whether a scan at `stamp` and `world_from_lidar` should be one, given the last one.
bool is_keyframe(const Keyframe& last, Time stamp, const Pose& world_from_lidar,
                 const Config& config);

/// Averages the scans from one keyframe to the next into it.
class KeyframeMerger {
 public:
  /// A new keyframe begins with these features.
  void begin(const Features& features);
  /// Adds a scan seen from the keyframe. Whether the keyframe's features should be renewed: when
  /// the scans have become four times as many, so that a map at rest does not change all the time.
  bool add(const Features& features, const Pose& keyframe_from_lidar, const Config& config);
  /// All scans so far, averaged.
  Features merged(const Config& config) const { return thinned(all_, config); }

 private:
  Features all_;
  int scans_ = 0;
};

/// Indices of the keyframes to match with at `now` around `position` (m), in order: one a cell of
/// those within the radius, the oldest (so that drift does not creep in), and the recent ones.
std::vector<std::uint32_t> surrounding(const std::vector<Keyframe>& keyframes,
                                       const Eigen::Vector3d& position, Time now,
                                       const Config& config);

/// The features of some keyframes in one map. When others are asked for, it pays for those that
/// come and go, and for the search tree.
class Submap {
 public:
  explicit Submap(const Config& config)
      : edges_(config.edge_leaf_m, config.grid_axes),
        surfaces_(config.surface_leaf_m, config.grid_axes) {}
  /// `chosen`: indices of `keyframes`, in order.
  void select(const std::vector<Keyframe>& keyframes, const std::vector<std::uint32_t>& chosen);
  const FeatureMap& map() const { return map_; }
  std::size_t size() const { return map_.edges.size() + map_.surfaces.size(); }
  std::uint64_t memory_bytes() const;

 private:
  /// What a keyframe brought in.
  struct Part {
    std::uint32_t revision = 0;
    Features placed;  ///< world frame
  };

  std::map<std::uint32_t, Part> parts_;  ///< by keyframe
  VoxelSums edges_;
  VoxelSums surfaces_;
  FeatureMap map_;
};

}  // namespace lidarena::lio_sam
