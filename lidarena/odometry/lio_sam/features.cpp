// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/odometry/lio_sam/features.hpp"

#include <algorithm>

#include "lidarena/estimation/deskew.hpp"
#include "lidarena/map/voxel_filter.hpp"

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

estimation::EdgeRule edge_rule_of(const Config& config) {
  estimation::EdgeRule rule =
      config.sensor == Sensor::kLivox ? estimation::kLivoxEdges : estimation::kSpinningEdges;
  rule.threshold_m2 = config.edge_threshold_m2;
  return rule;
}

Features features_of(std::span<const estimation::Pixel> row, const Config& config) {
  const std::vector<bool> is_edge = estimation::find_edges(row, edge_rule_of(config));
  Features features;
  for (std::size_t i = 0; i < row.size(); ++i)
    (is_edge[i] ? features.edges : features.surfaces).push_back(row[i].position);
  features.surfaces = map::voxel_means(features.surfaces, config.row_surface_voxel_size_m);
  return features;
}

}  // namespace

estimation::ImageLayout layout_of(const Config& config) {
  return {.by_azimuth = config.sensor == Sensor::kSpinning,
          .columns = config.columns,
          .row_stride = config.row_stride,
          .min_range_m = config.min_range_m,
          .max_range_m = config.max_range_m};
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

Features extract_features(const estimation::RangeImage& image, const Config& config,
                          const Parallel& parallel) {
  std::vector<Features> rows(image.row_end.size());
  parallel.for_each(rows.size(), 1,
                    [&](std::size_t r) { rows[r] = features_of(image.row(r), config); });
  Features all;
  for (const Features& row : rows) {
    all.edges.insert(all.edges.end(), row.edges.begin(), row.edges.end());
    all.surfaces.insert(all.surfaces.end(), row.surfaces.begin(), row.surfaces.end());
  }
  return all;
}

Features thinned(const Features& features, const Config& config) {
  return {map::voxel_means(features.edges, config.edge_voxel_size_m),
          map::voxel_means(features.surfaces, config.surface_voxel_size_m)};
}

}  // namespace lidarena::odometry::lio_sam
