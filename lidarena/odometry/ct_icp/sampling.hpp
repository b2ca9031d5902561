// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "lidarena/base/scan.hpp"
#include "lidarena/estimation/scan_times.hpp"
#include "lidarena/odometry/ct_icp/config.hpp"

namespace lidarena::ct_icp {

/// A point and when it was measured.
struct TimedPoint {
  Eigen::Vector3f position;  ///< m, lidar frame at its own instant
  float alpha;               ///< 0 the scan's first instant, 1 its last
};

/// The scan's finite points within the range gate. A `rigid` scan has alpha 1 throughout: it was
/// taken at its last instant.
std::vector<TimedPoint> timed_points(const Scan& scan, const ScanTimes& times, bool rigid,
                                     const SamplingConfig& config);

/// Of each cubic cell (edge in m) one point, drawn evenly from all that lie in it, so that the
/// sample covers the scan's duration evenly. Which one depends on the input alone; the order is as
/// mixed.
std::vector<TimedPoint> thin(std::span<const TimedPoint> points, double voxel,
                             VoxelRounding rounding);

/// The points to register among those of a thinned scan (CT-ICP, III-A). `limit` at most, unless 0.
std::vector<TimedPoint> sample_keypoints(std::span<const TimedPoint> frame,
                                         KeypointSampling sampling, double voxel, int limit,
                                         VoxelRounding rounding);

}  // namespace lidarena::ct_icp
