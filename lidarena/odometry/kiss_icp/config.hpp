// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "lidarena/base/config.hpp"
#include "lidarena/base/rig.hpp"
#include "lidarena/odometry/kiss_icp/release.hpp"

namespace lidarena::odometry::kiss_icp {

/// The parameters of the published program. The defaults are those that both releases share.
struct Config {
  Release release = Release::kV0_2;

  double max_range_m = 100.0;
  double min_range_m = 0.0;
  std::optional<double> voxel_size_m;  ///< unset: max_range_m / 100
  int max_points_per_voxel = 20;

  bool deskew = true;

  double initial_threshold_m = 2.0;
  double min_motion_m = 0.1;

  int max_iterations = 500;
  double convergence = 1e-4;

  double voxel_size() const { return voxel_size_m.value_or(max_range_m / 100.0); }

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("release", self.release, "",
      "release of the published program: v0_2, of 2023, the year of the paper, or head, of late "
      "2025; they differ in the cells of the map, the order of thinned points, the adaptive "
      "threshold, the robust kernel and the instant of the pose");
    v("max_range_m", self.max_range_m, "m",
      "farther points are dropped; also the local map's radius and the lever arm of the adaptive "
      "threshold",
      above(0));
    v("min_range_m", self.min_range_m, "m", "nearer points are dropped", at_least(0));
    v("voxel_size_m", self.voxel_size_m, "m",
      "voxel size of the map, null: max_range_m / 100; smaller is more accurate and slower",
      above(0));
    v("max_points_per_voxel", self.max_points_per_voxel, "",
      "maximum number of points in a map cell", Limits{1, 4096});
    v("deskew", self.deskew, "",
      "remove the motion within the scan, if its points carry times; a scan whose points all have "
      "the same time then loses all of them");
    v("initial_threshold_m", self.initial_threshold_m, "m",
      "initial sigma of the prediction's error; the search radius is 3 sigma", above(0));
    v("min_motion_m", self.min_motion_m, "m",
      "smaller errors of the prediction do not enter sigma; v0_2 starts to count them 5 times as "
      "far from the start",
      at_least(0));
    v("max_iterations", self.max_iterations, "",
      "maximum number of ICP iterations; bounds the time of a scan that does not converge",
      at_least(1));
    v("convergence", self.convergence, "m and rad", "ICP ends when the norm of its step is smaller",
      at_least(0));
  }
};

/// v0.2 as shipped, for cars.
Config published(const LidarInfo& lidar);
/// The program of late 2025 as shipped.
Config head(const LidarInfo& lidar);
/// v0.2 as a user would set it for a small sensor in rooms and tunnels.
Config indoor(const LidarInfo& lidar);

}  // namespace lidarena::odometry::kiss_icp
