// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/odometry/kiss_icp/release.hpp"

#include <cmath>

namespace lidarena::odometry::kiss_icp {

map::VoxelRounding cell_rounding(Release release) {
  return release == Release::kV0_2 ? map::VoxelRounding::kTruncate : map::VoxelRounding::kFloor;
}

double point_spacing(Release release, double voxel_size, int max_points) {
  return release == Release::kV0_2 ? 0.0 : voxel_size / std::sqrt(max_points);
}

std::uint32_t hash_factor_y(Release release) {
  return release == Release::kV0_2 ? 19349663U : 19349669U;
}

double initial_samples(Release release) { return release == Release::kV0_2 ? 0.0 : 1.0; }

bool counts_errors_at(Release release, const Pose& map_from_lidar, double min_motion) {
  constexpr double kMotionsToMove = 5.0;
  return release == Release::kHead ||
         map_from_lidar.translation().norm() > kMotionsToMove * min_motion;
}

double kernel_scale(Release release, double sigma) {
  return release == Release::kV0_2 ? sigma / 3.0 : sigma;
}

Time pose_instant(Release release, const estimation::ScanTimes& times) {
  return release == Release::kV0_2 ? times.first + (times.last - times.first) / 2 : times.last;
}

std::size_t scans_before_deskewing(Release release) { return release == Release::kV0_2 ? 3 : 0; }

}  // namespace lidarena::odometry::kiss_icp
