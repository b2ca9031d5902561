// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/odometry/arena_slam/keyframes.hpp"

#include <gtest/gtest.h>

namespace lidarena::odometry::arena_slam {
namespace {

TEST(ArenaSlamKeyframes, AreTheAverageOfTheScansUpToTheNextAndRarelyRenewed) {
  Config config;
  config.scans_per_keyframe = 16;
  const map::Features scan{{}, {{1.0F, 0.0F, 0.0F}}};
  KeyframeMerger merger;
  merger.begin(scan);
  std::vector<int> renewed;
  for (int scans = 2; scans <= 20; ++scans) {
    const Pose keyframe_from_lidar = make_pose(Eigen::Matrix3d::Identity(), {0.032, 0.0, 0.0});
    if (merger.add(scan, keyframe_from_lidar, config)) renewed.push_back(scans);
  }
  EXPECT_EQ(renewed, (std::vector<int>{4, 16}));
  const map::Features merged = merger.merged(config);
  ASSERT_EQ(merged.surfaces.size(), 1U);
  EXPECT_NEAR(merged.surfaces[0].x(), 1.03, 1e-4) << "the first at 1, fifteen at 1.032";
}

}  // namespace
}  // namespace lidarena::odometry::arena_slam
