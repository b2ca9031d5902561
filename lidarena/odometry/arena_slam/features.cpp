// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/odometry/arena_slam/features.hpp"

#include "lidarena/map/voxel_filter.hpp"

namespace lidarena::odometry::arena_slam {
namespace {

constexpr std::size_t kRows = 8;  // per task

}  // namespace

FeatureRule feature_rule(const LidarInfo& lidar, const Config& config) {
  FeatureRule rule;
  rule.layout.by_azimuth = lidar.kind == "spinning";
  if (lidar.columns > 0) rule.layout.columns = lidar.columns;
  rule.layout.min_range_m = config.min_range_m;
  rule.layout.max_range_m = config.max_range_m;
  rule.edges = rule.layout.by_azimuth ? estimation::kSpinningEdges : estimation::kLivoxEdges;
  return rule;
}

Features extract_features(const estimation::RangeImage& image, const estimation::EdgeRule& rule,
                          const Parallel& parallel) {
  return parallel.reduce(
      image.row_end.size(), kRows, Features{},
      [&](std::size_t begin, std::size_t end) {
        Features part;
        for (std::size_t r = begin; r < end; ++r) {
          const auto row = image.row(r);
          const std::vector<bool> edges = estimation::find_edges(row, rule);
          for (std::size_t i = 0; i < row.size(); ++i)
            (edges[i] ? part.edges : part.surfaces).push_back(row[i].position);
        }
        return part;
      },
      [](Features& all, const Features& part) {
        all.edges.insert(all.edges.end(), part.edges.begin(), part.edges.end());
        all.surfaces.insert(all.surfaces.end(), part.surfaces.begin(), part.surfaces.end());
      });
}

Features thinned(const Features& features, const Config& config) {
  constexpr auto kAxes = map::GridAxes::kRotated;
  return {map::voxel_means(features.edges, config.edge_voxel_size_m, kAxes),
          map::voxel_means(features.surfaces, config.surface_voxel_size_m, kAxes)};
}

}  // namespace lidarena::odometry::arena_slam
