// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "lidarena/base/pose.hpp"
#include "lidarena/base/time.hpp"
#include "lidarena/map/submap.hpp"
#include "lidarena/odometry/arena_slam/config.hpp"
#include "lidarena/odometry/arena_slam/features.hpp"

namespace lidarena::odometry::arena_slam {

/// A scan kept for the map.
struct Keyframe {
  Time stamp{0};
  Pose world_from_lidar = Pose::Identity();
  Features features;           ///< downsampled, LiDAR frame
  std::uint32_t revision = 0;  ///< number of changes of pose or features
};

/// Whether a scan at `world_from_lidar` should be a keyframe, given the last one.
bool is_keyframe(const Keyframe& last, const Pose& world_from_lidar, const Config& config);

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

/// Map with which a scan is matched: edges and surfaces of keyframes.
struct FeatureMap {
  map::Submap edges;
  map::Submap surfaces;

  explicit FeatureMap(const Config& config)
      : edges(config.edge_voxel_size_m, map::GridAxes::kRotated),
        surfaces(config.surface_voxel_size_m, map::GridAxes::kRotated) {}
  /// Selects the keyframes around the last one at `now`.
  void follow(const std::vector<Keyframe>& keyframes, Time now, const Config& config);
  /// `chosen`: sorted indices of `keyframes`.
  void select(const std::vector<Keyframe>& keyframes, const std::vector<std::uint32_t>& chosen);
  std::size_t size() const { return edges.size() + surfaces.size(); }
  std::uint64_t memory_bytes() const { return edges.memory_bytes() + surfaces.memory_bytes(); }
};

}  // namespace lidarena::odometry::arena_slam
