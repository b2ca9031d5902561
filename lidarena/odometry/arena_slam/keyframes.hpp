// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "lidarena/base/pose.hpp"
#include "lidarena/odometry/arena_slam/features.hpp"

namespace lidarena::odometry::arena_slam {

/// Averages the scans up to the next keyframe into the last one.
class KeyframeMerger {
 public:
  /// Starts a new keyframe with these features.
  void begin(const map::Features& features);
  /// Adds a scan. Returns whether the keyframe's features should be replaced by merged(): each time
  /// the number of scans has quadrupled, so that the map of a sensor at rest rarely changes.
  bool add(const map::Features& features, const Pose& keyframe_from_lidar, const Config& config);
  /// Average of all scans added so far.
  map::Features merged(const Config& config) const {
    return map::thinned(all_, feature_voxels(config));
  }

 private:
  map::Features all_;
  int scans_ = 0;
};

}  // namespace lidarena::odometry::arena_slam
