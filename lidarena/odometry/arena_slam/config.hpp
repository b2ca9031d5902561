// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "lidarena/base/config.hpp"
#include "lidarena/base/rig.hpp"
#include "lidarena/loop/config.hpp"

namespace lidarena::odometry::arena_slam {

struct Config {
  double min_range_m = 0.3;
  double max_range_m = 100.0;
  double edge_voxel_size_m = 0.1;
  double surface_voxel_size_m = 0.15;
  double max_plane_thickness_m = 0.06;

  double keyframe_translation_m = 1.0;
  double keyframe_rotation_rad = 0.2;
  int scans_per_keyframe = 16;
  double submap_radius_m = 20.0;
  double submap_keyframe_spacing_m = 2.0;
  double submap_recent_s = 10.0;

  double gravity = 9.80665;
  double imu_noise_factor = 10.0;
  double point_sigma_m = 0.1;

  loop::LoopConfig loop;

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("min_range_m", self.min_range_m, "m", "nearer points are dropped", at_least(0));
    v("max_range_m", self.max_range_m, "m", "farther points are dropped", above(0));
    v("edge_voxel_size_m", self.edge_voxel_size_m, "m",
      "voxel size in which edge points are averaged", above(0));
    v("surface_voxel_size_m", self.surface_voxel_size_m, "m",
      "voxel size in which surface points are averaged", above(0));
    v("max_plane_thickness_m", self.max_plane_thickness_m, "m",
      "maximum distance of a neighbor from the plane fitted to all", above(0));
    v("keyframe_translation_m", self.keyframe_translation_m, "m",
      "a scan becomes a keyframe after this translation since the last one", above(0));
    v("keyframe_rotation_rad", self.keyframe_rotation_rad, "rad",
      "a scan becomes a keyframe after this rotation about an axis since the last one", above(0));
    v("scans_per_keyframe", self.scans_per_keyframe, "",
      "upper limit on the scans that are averaged into a keyframe", at_least(1));
    v("submap_radius_m", self.submap_radius_m, "m",
      "radius around the last keyframe within which keyframes enter the submap", above(0));
    v("submap_keyframe_spacing_m", self.submap_keyframe_spacing_m, "m",
      "edge of the cells from each of which the oldest keyframe enters the submap", above(0));
    v("submap_recent_s", self.submap_recent_s, "s",
      "all keyframes within the radius that are not older enter the submap too", at_least(0));
    v("gravity", self.gravity, "m/s^2", "magnitude of gravity", above(0));
    v("imu_noise_factor", self.imu_noise_factor, "", "factor on the data sheet's noise densities",
      above(0));
    v("point_sigma_m", self.point_sigma_m, "m",
      "sigma of a point's distance, by which the smoother weights each direction of a registered "
      "pose by what the points determine",
      above(0));
    v("loop", self.loop, "", "how loop candidates are found and verified");
  }
};

/// The settings for `lidar`.
Config settings_for(const LidarInfo& lidar);

}  // namespace lidarena::odometry::arena_slam
