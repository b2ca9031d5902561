// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "lidarena/base/parallel.hpp"
#include "lidarena/base/scan.hpp"
#include "lidarena/estimation/motion_filter.hpp"
#include "lidarena/estimation/scan_times.hpp"
#include "lidarena/odometry/arena_lo/config.hpp"

namespace lidarena::odometry::arena_lo {

/// Part of a scan, so short that the sensor's accelerations are constant within it.
struct Slice {
  struct Point {
    Eigen::Vector3f position;  ///< m, lidar frame at its own instant
    float seconds;             ///< since the slice's middle
  };
  Time middle{0};
  std::vector<Point> points;
};

/// The scan's finite points within the range limits, in slices of equal duration, of at most
/// `longest` seconds. A scan without times is a single slice of which all points have the same
/// instant.
std::vector<Slice> slices_of(const Scan& scan, const estimation::ScanTimes& times, double longest,
                             const Config& config);

std::size_t count_points(const std::vector<Slice>& slices);

/// Positions (m) of a slice's points in the frame that `to` leads to from the world, of a sensor
/// with this motion at the slice's middle.
std::vector<Eigen::Vector3f> placed(const Slice& slice, const estimation::MotionState& motion,
                                    const Pose& to, const Parallel& parallel);

/// The slice's points in the lidar's frame at its middle, averaged in voxels, and of the averages
/// at most `most`.
std::vector<Eigen::Vector3f> averages(const Slice& slice, const estimation::MotionState& motion,
                                      int most, const Config& config, const Parallel& parallel);

}  // namespace lidarena::odometry::arena_lo
