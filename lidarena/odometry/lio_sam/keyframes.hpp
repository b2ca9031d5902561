// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "lidarena/base/pose.hpp"
#include "lidarena/map/submap.hpp"
#include "lidarena/odometry/lio_sam/features.hpp"

namespace lidarena::odometry::lio_sam {

/// A scan kept for the map.
struct Keyframe {
  Time stamp{0};
  Pose world_from_lidar = Pose::Identity();
  Features features;           ///< downsampled, LiDAR frame
  std::uint32_t revision = 0;  ///< number of changes of the pose
};

/// Whether a scan at `stamp` and `world_from_lidar` should be a keyframe, given the last one: it
/// has moved, or, with Livox sensors, the last one is older than a second.
bool is_keyframe(const Keyframe& last, Time stamp, const Pose& world_from_lidar,
                 const Config& config);

/// Map with which a scan is matched: edges and surfaces of the keyframes around the last one.
class FeatureMap {
 public:
  explicit FeatureMap(const Config& config)
      : edges_(config.edge_voxel_size_m),
        surfaces_(config.surface_voxel_size_m),
        extent_{.radius_m = config.submap_radius_m,
                .keyframe_spacing_m = config.submap_keyframe_spacing_m} {}
  /// Selects keyframes (there must be one) for a scan at `now`.
  void follow(const std::vector<Keyframe>& keyframes, Time now);

  const map::KdTree& edges() const { return edges_.tree(); }
  const map::KdTree& surfaces() const { return surfaces_.tree(); }
  std::size_t size() const { return edges_.size() + surfaces_.size(); }
  std::uint64_t memory_bytes() const { return edges_.memory_bytes() + surfaces_.memory_bytes(); }

 private:
  map::Submap edges_;
  map::Submap surfaces_;
  map::SubmapExtent extent_;
};

}  // namespace lidarena::odometry::lio_sam
