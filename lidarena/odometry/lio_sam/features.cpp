// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/odometry/lio_sam/features.hpp"

#include <algorithm>

#include "lidarena/estimation/deskew.hpp"

namespace lidarena::odometry::lio_sam {
namespace {

Pose rotation_of(const Pose& pose) {
  return make_pose(Eigen::Matrix3d(pose.linear()), Eigen::Vector3d::Zero());
}

/// The rotations of `track`, constant from `until` on.
estimation::ImuTrack rotations_of(const estimation::ImuTrack& track, Time until) {
  estimation::ImuTrack rotations;
  for (const estimation::ImuStep& step : track)
    rotations.push_back({.begin = step.begin,
                         .world_from_imu = rotation_of(step.world_from_imu),
                         .rate = step.rate});
  rotations.push_back({.begin = until, .world_from_imu = estimation::pose_at(rotations, until)});
  return rotations;
}

}  // namespace

FeatureRule feature_rule(const Config& config) {
  FeatureRule rule;
  rule.layout = {.by_azimuth = config.sensor == Sensor::kSpinning,
                 .columns = config.columns,
                 .row_stride = config.row_stride,
                 .min_range_m = config.min_range_m,
                 .max_range_m = config.max_range_m};
  rule.edges =
      config.sensor == Sensor::kLivox ? estimation::kLivoxEdges : estimation::kSpinningEdges;
  rule.edges.threshold_m2 = config.edge_threshold_m2;
  rule.row_surface_voxel_size_m = config.row_surface_voxel_size_m;
  return rule;
}

Time end_in_message(const Scan& scan) {
  const bool known = scan.timed && !scan.points.empty();
  return known ? std::max(scan.stamp, time_of(scan, scan.points.back())) : scan.stamp;
}

std::vector<Eigen::Vector3f> deskewed(const Scan& scan, const estimation::ImuTrack& track,
                                      Time known_until, const Pose& imu_from_lidar,
                                      const estimation::ImageLayout& layout) {
  const auto first = std::find_if(scan.points.begin(), scan.points.end(), [&](const Point& point) {
    return estimation::is_usable(point, layout);
  });
  if (track.empty() || first == scan.points.end()) return estimation::positions(scan);
  const estimation::ImuTrack rotations = rotations_of(track, known_until);
  return estimation::deskew(scan, rotations, rotation_of(imu_from_lidar),
                            estimation::pose_at(rotations, time_of(scan, *first)), Parallel(1));
}

}  // namespace lidarena::odometry::lio_sam
