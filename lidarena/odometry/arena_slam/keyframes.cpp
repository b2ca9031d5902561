// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/odometry/arena_slam/keyframes.hpp"

namespace lidarena::odometry::arena_slam {
namespace {

/// With more scans than one, a keyframe is renewed when it has these numbers of them.
bool is_renewal(int scans) { return scans == 4 || scans == 16 || scans == 64; }

}  // namespace

void KeyframeMerger::begin(const map::Features& features) {
  all_ = features;
  scans_ = 1;
}

bool KeyframeMerger::add(const map::Features& features, const Pose& keyframe_from_lidar,
                         const Config& config) {
  if (scans_ >= config.scans_per_keyframe) return false;
  map::append_placed(keyframe_from_lidar, features.edges, all_.edges);
  map::append_placed(keyframe_from_lidar, features.surfaces, all_.surfaces);
  ++scans_;
  return is_renewal(scans_);
}

}  // namespace lidarena::odometry::arena_slam
