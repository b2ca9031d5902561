// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "lidarena/base/parallel.hpp"
#include "lidarena/estimation/edge_points.hpp"
#include "lidarena/estimation/imu_track.hpp"
#include "lidarena/odometry/lio_sam/config.hpp"

namespace lidarena::odometry::lio_sam {

/// Points of a scan for matching with the map (m, LiDAR frame).
struct Features {
  std::vector<Eigen::Vector3f> edges;
  std::vector<Eigen::Vector3f> surfaces;
};

/// Layout of the range image.
estimation::ImageLayout layout_of(const Config& config);

/// The program's instant of the scan's last firing: that of the last point in message order. The
/// stamp if the scan is untimed or has no points.
Time end_in_message(const Scan& scan);

/// Positions (m) of all points, in order, turned to the LiDAR's attitude at the first usable point
/// in message order. The translation within the scan is not removed. Points later than
/// `known_until` get the rotation of that instant. Untimed scans are returned unchanged.
std::vector<Eigen::Vector3f> deskewed(const Scan& scan, const estimation::ImuTrack& track,
                                      Time known_until, const Pose& imu_from_lidar,
                                      const estimation::ImageLayout& layout);

/// The edges of each row, and all its other points, averaged in voxels, as surface points.
Features extract_features(const estimation::RangeImage& image, const Config& config,
                          const Parallel& parallel);

/// The features averaged in voxels of `edge_voxel_size_m` and `surface_voxel_size_m`.
Features thinned(const Features& features, const Config& config);

}  // namespace lidarena::odometry::lio_sam
