// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <vector>

#include "lidarena/odometry/ct_icp/config.hpp"
#include "lidarena/odometry/ct_icp/elastic_motion.hpp"

namespace lidarena::odometry::ct_icp {

/// One point of each cubic cell (edge in m), drawn uniformly from those in it. Coordinates are
/// truncated to cells, so that the cells around x, y, z = 0 are twice as wide.
std::vector<TimedPoint> thin(std::span<const TimedPoint> points, double voxel);

/// Keypoints of a downsampled scan (CT-ICP, III-A). `starting`: the scan is one of the first
/// initial_scans.
std::vector<TimedPoint> sample_keypoints(std::span<const TimedPoint> frame,
                                         const SamplingConfig& config, bool starting);

}  // namespace lidarena::odometry::ct_icp
