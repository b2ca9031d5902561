// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/odometry/ct_icp/sampling.hpp"

#include <gtest/gtest.h>

#include <map>

namespace lidarena::odometry::ct_icp {
namespace {

TEST(CtIcpSampling, CellsAboutZeroAreTwiceAsWide) {
  const std::vector<TimedPoint> points{
      {{-0.9F, 0.1F, 0.1F}, 0}, {{0.9F, 0.1F, 0.1F}, 0}, {{1.1F, 0.1F, 0.1F}, 0}};
  EXPECT_EQ(thin(points, 1.0).size(), 2U);
}

/// At several ranges along x, 32 points along z in steps of 1 cm, away from the cells' faces.
std::vector<TimedPoint> combs() {
  std::vector<TimedPoint> points;
  for (const float range : {0.3F, 1.5F, 3.0F, 6.0F, 12.0F, 100.0F, 300.0F}) {
    const float low = range < 2.0F ? 0.005F : 1.605F;
    for (int i = 0; i < 32; ++i)
      points.push_back({{range, 0.05F, low + 0.01F * static_cast<float>(i)}, 0.0F});
  }
  return points;
}

TEST(CtIcpSampling, AdaptiveCellsGrowWithTheRange) {
  SamplingConfig config;
  config.max_keypoints = 0;
  std::map<float, int> counts;
  for (const TimedPoint& point : sample_keypoints(combs(), config, false))
    ++counts[point.position.x()];
  EXPECT_EQ(counts.count(0.3F), 0U) << "nearer than 0.5 m";
  EXPECT_EQ(counts.count(300.0F), 0U) << "farther than 200 m";
  EXPECT_EQ(counts[1.5F], 4) << "cells of 0.1 m";
  EXPECT_EQ(counts[3.0F], 2) << "cells of 0.2 m";
  EXPECT_EQ(counts[6.0F], 1) << "cells of 0.4 m";
  EXPECT_EQ(counts[12.0F], 1) << "cells of 0.8 m";
  EXPECT_EQ(counts[100.0F], 1) << "cells of 1.6 m";
}

TEST(CtIcpSampling, TheLimitHoldsAfterTheFirstScansOnly) {
  SamplingConfig config;
  config.max_keypoints = 5;
  EXPECT_EQ(sample_keypoints(combs(), config, false).size(), 5U);
  EXPECT_EQ(sample_keypoints(combs(), config, true).size(), 9U) << "4 + 2 + 1 + 1 + 1";
}

TEST(CtIcpSampling, TheGridHasCellsOfItsOwnForTheFirstScans) {
  SamplingConfig config;
  config.keypoints = KeypointSampling::kGrid;
  config.keypoint_voxel_size_m = 1.0;
  config.initial_keypoint_voxel_size_m = 0.1;
  // 1.605 to 1.915 m: one cell of 1 m, four of 0.1 m; nearer ones from 0.005 to 0.315 likewise
  EXPECT_EQ(sample_keypoints(combs(), config, false).size(), 7U);
  EXPECT_EQ(sample_keypoints(combs(), config, true).size(), 28U);
  config.keypoints = KeypointSampling::kAll;
  config.max_keypoints = 0;
  EXPECT_EQ(sample_keypoints(combs(), config, false).size(), combs().size());
}

}  // namespace
}  // namespace lidarena::odometry::ct_icp
