// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <vector>

#include "lidarena/estimation/elastic_scan.hpp"
#include "lidarena/odometry/arena_lo/config.hpp"

namespace lidarena::odometry::arena_lo {

using estimation::TimedPoint;

/// One point of each cubic cell (edge in m), drawn uniformly from those in it, so that the sample
/// covers the scan's duration evenly.
std::vector<TimedPoint> thin(std::span<const TimedPoint> points, double voxel);

/// One point of each larger cell of a downsampled scan, at most max_keypoints, drawn at random.
std::vector<TimedPoint> sample_keypoints(std::span<const TimedPoint> frame,
                                         const SamplingConfig& config);

}  // namespace lidarena::odometry::arena_lo
