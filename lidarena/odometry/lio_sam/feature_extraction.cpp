// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/odometry/lio_sam/feature_extraction.hpp"

#include "lidarena/map/voxel_filter.hpp"

namespace lidarena::odometry::lio_sam {
namespace {

using map::Features;

constexpr std::size_t kRows = 1;  // per task: about 0.1 ms

Features features_of(std::span<const estimation::Pixel> row, const FeatureRule& rule) {
  const std::vector<bool> is_edge = estimation::find_edges(row, rule.edges);
  Features features;
  for (std::size_t i = 0; i < row.size(); ++i)
    (is_edge[i] ? features.edges : features.surfaces).push_back(row[i].position);
  features.surfaces = map::voxel_means(features.surfaces, rule.row_surface_voxel_size_m);
  return features;
}

void append(Features& all, const Features& part) {
  all.edges.insert(all.edges.end(), part.edges.begin(), part.edges.end());
  all.surfaces.insert(all.surfaces.end(), part.surfaces.begin(), part.surfaces.end());
}

}  // namespace

Features extract_features(const estimation::RangeImage& image, const FeatureRule& rule,
                          const Parallel& parallel) {
  return parallel.reduce(
      image.row_end.size(), kRows, Features{},
      [&](std::size_t begin, std::size_t end) {
        Features part;
        for (std::size_t r = begin; r < end; ++r) append(part, features_of(image.row(r), rule));
        return part;
      },
      append);
}

}  // namespace lidarena::odometry::lio_sam
