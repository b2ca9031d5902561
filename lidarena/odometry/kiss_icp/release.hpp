// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>

#include "lidarena/base/pose.hpp"
#include "lidarena/base/time.hpp"
#include "lidarena/estimation/scan_times.hpp"
#include "lidarena/map/voxel_key.hpp"

namespace lidarena::odometry::kiss_icp {

/// Release of the published program. The functions below are all that differs between the two.
enum class Release {
  kV0_2,  ///< of 2023, the year of the paper
  kHead,  ///< of late 2025
};

constexpr auto enum_names(Release) {
  return std::array{std::pair{"v0_2", Release::kV0_2}, std::pair{"head", Release::kHead}};
}

/// How coordinates are rounded to cells, in the map and in thinning: v0.2 truncates, so that the
/// cells around x, y, z = 0 are twice as wide.
inline map::VoxelRounding cell_rounding(Release release) {
  return release == Release::kV0_2 ? map::VoxelRounding::kTruncate : map::VoxelRounding::kFloor;
}

/// Least distance (m) between the points of a map cell: v0.2 keeps the first points of a cell, head
/// spaces them by voxel_size / sqrt(max_points).
inline double point_spacing(Release release, double voxel_size, int max_points) {
  return release == Release::kV0_2 ? 0.0 : voxel_size / std::sqrt(max_points);
}

/// Factor of a cell's y index in the hash by which thinned points are ordered, see thin().
inline std::uint32_t hash_factor_y(Release release) {
  return release == Release::kV0_2 ? 19349663U : 19349669U;
}

/// Number of samples for which the initial sigma counts in the adaptive threshold for good.
inline double initial_samples(Release release) { return release == Release::kV0_2 ? 0.0 : 1.0; }

/// Whether the adaptive threshold counts the error of the prediction of the pose `map_from_lidar`
/// and uses what it has counted: v0.2 only farther than 5 `min_motion` (m) from the start.
inline bool counts_errors_at(Release release, const Pose& map_from_lidar, double min_motion) {
  constexpr double kMotionsToMove = 5.0;
  return release == Release::kHead ||
         map_from_lidar.translation().norm() > kMotionsToMove * min_motion;
}

/// The `scale` of kernel_weight() for the adaptive threshold's `sigma` (m).
inline double kernel_scale(Release release, double sigma) {
  return release == Release::kV0_2 ? sigma / 3.0 : sigma;
}

/// Instant of the scan at which its pose holds and to which its points are de-skewed: the middle
/// of the scan in v0.2, its end in head.
inline Time pose_instant(Release release, const estimation::ScanTimes& times) {
  return release == Release::kV0_2 ? times.first + (times.last - times.first) / 2 : times.last;
}

/// Number of scans at the start that are not de-skewed.
inline std::size_t scans_before_deskewing(Release release) {
  return release == Release::kV0_2 ? 3 : 0;
}

}  // namespace lidarena::odometry::kiss_icp
