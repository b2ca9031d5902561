// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "lidarena/estimation/imu_track.hpp"
#include "lidarena/odometry/lio_sam/config.hpp"
#include "lidarena/odometry/lio_sam/feature_extraction.hpp"

namespace lidarena::odometry::lio_sam {

/// The program's features, or those of its port.
FeatureRule feature_rule(const Config& config);

/// The program's instant of the scan's last firing: that of the last point in message order. The
/// stamp if the scan is untimed or has no points.
Time end_in_message(const Scan& scan);

/// Positions (m) of all points, in order, turned to the LiDAR's attitude at the first usable point
/// in message order. The translation within the scan is not removed. Points later than
/// `known_until` get the rotation of that instant. Untimed scans are returned unchanged.
std::vector<Eigen::Vector3f> deskewed(const Scan& scan, const estimation::ImuTrack& track,
                                      Time known_until, const Pose& imu_from_lidar,
                                      const estimation::ImageLayout& layout);

}  // namespace lidarena::odometry::lio_sam
