// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/odometry/lio_sam/feature_extraction.hpp"

#include <gtest/gtest.h>

#include <cstdlib>

namespace lidarena::odometry::lio_sam {
namespace {

constexpr int kColumns = 120;
/// All points of a row stay: they lie 1 cm apart.
const FeatureRule kAllPoints{.layout = {}, .edges = {}, .row_surface_voxel_size_m = 0.001};

/// Rows of two walls with an edge between them, at 4 m, all rows in the same place.
estimation::RangeImage corner(int rows) {
  estimation::RangeImage image;
  for (int row = 0; row < rows; ++row) {
    for (int i = 0; i < kColumns; ++i) {
      const float range = 4.0F + 0.04F * static_cast<float>(std::abs(i - kColumns / 2));
      image.pixels.push_back({{range, 0.01F * static_cast<float>(i), 0.0F}, range, i});
    }
    image.row_end.push_back(image.pixels.size());
  }
  return image;
}

TEST(FeatureExtraction, WhatIsNoEdgeIsASurface) {
  const map::Features features = extract_features(corner(2), kAllPoints, Parallel(1));
  ASSERT_EQ(features.edges.size(), 2U);
  EXPECT_EQ(features.edges[0].x(), 4.0F);
  EXPECT_EQ(features.surfaces.size(), 2U * (kColumns - 1));
}

TEST(FeatureExtraction, SurfacesAreAveragedRowByRow) {
  FeatureRule rule = kAllPoints;
  rule.row_surface_voxel_size_m = 20.0;
  const map::Features features = extract_features(corner(2), rule, Parallel(1));
  EXPECT_EQ(features.surfaces.size(), 2U) << "one mean a row, although both rows lie in one voxel";
}

TEST(FeatureExtraction, RowsStayInOrderOnAnyNumberOfThreads) {
  estimation::RangeImage image = corner(40);
  for (std::size_t i = 0; i < image.pixels.size(); ++i)
    image.pixels[i].position.z() = static_cast<float>(i / kColumns);
  const map::Features one = extract_features(image, kAllPoints, Parallel(1));
  const map::Features four = extract_features(image, kAllPoints, Parallel(4));
  ASSERT_EQ(one.edges.size(), 40U);
  for (std::size_t row = 0; row < 40; ++row) EXPECT_EQ(one.edges[row].z(), static_cast<float>(row));
  EXPECT_EQ(one.edges, four.edges);
  EXPECT_EQ(one.surfaces, four.surfaces);
}

}  // namespace
}  // namespace lidarena::odometry::lio_sam
