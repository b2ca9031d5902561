// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "lidarena/base/scan.hpp"
#include "lidarena/estimation/scan_times.hpp"
#include "lidarena/odometry/arena_lo/config.hpp"

namespace lidarena::odometry::arena_lo {

/// A point and its instant within the scan.
struct TimedPoint {
  Eigen::Vector3f position;  ///< m, lidar frame at its own instant
  float alpha;               ///< 0 the scan's first instant, 1 its last
};

/// The scan's finite points within the range gate. In a `rigid` scan all have alpha 1, as if it was
/// taken at its last instant.
std::vector<TimedPoint> timed_points(const Scan& scan, const estimation::ScanTimes& times,
                                     bool rigid, const SamplingConfig& config);

/// One point of each cubic cell (edge in m), drawn uniformly from those in it, so that the sample
/// covers the scan's duration evenly. The choice depends on the input only, and so does the order,
/// by the hashes of the cells, which looks random.
std::vector<TimedPoint> thin(std::span<const TimedPoint> points, double voxel,
                             map::VoxelRounding rounding);

/// Keypoints of a downsampled scan (CT-ICP, III-A), at most `limit` unless that is 0.
std::vector<TimedPoint> sample_keypoints(std::span<const TimedPoint> frame,
                                         KeypointSampling sampling, double voxel, int limit,
                                         map::VoxelRounding rounding);

}  // namespace lidarena::odometry::arena_lo
