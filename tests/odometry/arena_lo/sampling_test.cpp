// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/odometry/arena_lo/sampling.hpp"

#include <gtest/gtest.h>

namespace lidarena::odometry::arena_lo {
namespace {

TEST(ArenaLoSampling, AllCellsHaveTheSameSize) {
  const std::vector<TimedPoint> points{
      {{-0.9F, 0.1F, 0.1F}, 0}, {{0.9F, 0.1F, 0.1F}, 0}, {{1.1F, 0.1F, 0.1F}, 0}};
  EXPECT_EQ(thin(points, 1.0).size(), 3U);
}

TEST(ArenaLoSampling, KeypointsAreOnePerCellAndNotTooMany) {
  std::vector<TimedPoint> points;
  for (int i = 0; i < 100; ++i)
    points.push_back({{0.005F + 0.1F * static_cast<float>(i), 0.0F, 0.0F}, 0.0F});
  SamplingConfig config;
  config.keypoint_voxel_size_m = 0.5;
  EXPECT_EQ(sample_keypoints(points, config).size(), 20U);
  config.max_keypoints = 7;
  EXPECT_EQ(sample_keypoints(points, config).size(), 7U);
}

}  // namespace
}  // namespace lidarena::odometry::arena_lo
