// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/odometry/lio_sam/keyframes.hpp"

#include <gtest/gtest.h>

#include "lidarena/base/so3.hpp"

namespace lidarena::odometry::lio_sam {
namespace {

TEST(LioSamKeyframes, ComeWithDistanceTurnAndInThePortWithTime) {
  Config config;
  const Keyframe last{from_seconds(10.0), Pose::Identity(), {}, 0};
  const auto moved = [](double x, double yaw) {
    return make_pose(so3::exp({0, 0, yaw}), {x, 0, 0});
  };
  EXPECT_FALSE(is_keyframe(last, from_seconds(100.0), moved(0.99, 0.19), config));
  EXPECT_TRUE(is_keyframe(last, from_seconds(11.0), moved(1.0, 0.0), config));
  EXPECT_TRUE(is_keyframe(last, from_seconds(11.0), moved(0.0, -0.2), config));
  config.sensor = Sensor::kLivox;
  EXPECT_FALSE(is_keyframe(last, from_seconds(11.0), moved(0.0, 0.0), config));
  EXPECT_TRUE(is_keyframe(last, from_seconds(11.1), moved(0.0, 0.0), config));
}

TEST(LioSamKeyframes, TheMapIsThatOfTheKeyframesNearTheLast) {
  std::vector<Keyframe> keyframes;
  for (const double x : {0.0, 30.0, 100.0}) {
    const Pose pose = make_pose(Eigen::Matrix3d::Identity(), {x, 0, 0});
    keyframes.push_back({from_seconds(x), pose, {{{1, 0, 0}}, {{0, 1, 0}}}, 0});
  }
  FeatureMap map(Config{});  // 50 m
  map.follow(keyframes, from_seconds(100.0));
  EXPECT_EQ(map.size(), 2U);
  keyframes.pop_back();
  map.follow(keyframes, from_seconds(101.0));
  EXPECT_EQ(map.edges().size(), 2U);
  EXPECT_EQ(map.surfaces().size(), 2U);
}

}  // namespace
}  // namespace lidarena::odometry::lio_sam
