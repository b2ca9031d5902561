// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "lidarena/base/pose.hpp"
#include "lidarena/base/se3.hpp"
#include "lidarena/estimation/scan_times.hpp"
#include "lidarena/odometry/kiss_icp/config.hpp"

namespace lidarena::odometry::kiss_icp {

using Points = std::vector<Eigen::Vector3f>;  ///< m

/// Edges of the cells of the two thinnings, in voxels of the map (paper, section III-B).
inline constexpr double kMapThinning = 0.5;
inline constexpr double kKeypointThinning = 1.5;

/// Twist per second (m/s, rad/s, lidar frame) within a scan: the `motion` between the previous two
/// poses divided by the duration of this scan (paper, eq. 2). Zero if the points have no times or
/// all the same.
se3::Vector6 twist_within(const estimation::ScanTimes& times, const Pose& motion);

/// The points between the minimum and the maximum range, both exclusive; none that are not finite.
Points in_range(const Points& points, const Config& config);

/// The first point of each voxel (edge in m), with its own coordinates, in the order of the slots
/// of the published program's hash table. In this pseudo-random order, a second, coarser pass takes
/// its points from the whole duration of the scan and not only from its beginning.
Points thin(const Points& points, double voxel_size, Release release);

}  // namespace lidarena::odometry::kiss_icp
