// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/map/feature_map.hpp"

#include <gtest/gtest.h>

#include "lidarena/base/so3.hpp"

namespace lidarena::map {
namespace {

TEST(Keyframes, TheNextComesAfterADistanceOrATurn) {
  const Keyframe last{from_seconds(10.0), Pose::Identity(), {}, 0};
  const auto pose = [](double x, double yaw) {
    return make_pose(so3::exp({0, 0, yaw}), {x, 0, 0});
  };
  EXPECT_FALSE(has_moved(last, pose(0.99, 0.19), 1.0, 0.2));
  EXPECT_TRUE(has_moved(last, pose(1.0, 0.0), 1.0, 0.2));
  EXPECT_TRUE(has_moved(last, pose(0.0, -0.2), 1.0, 0.2));
}

TEST(Keyframes, TakeTheirPointsAlongWhenTheyMove) {
  std::vector<Keyframe> keyframes(2);
  keyframes[1].features = {{{1, 0, 0}}, {{2, 0, 0}}};
  const Pose moved = make_pose(Eigen::Matrix3d::Identity(), {0, 3, 0});
  move_to({Pose::Identity(), moved}, keyframes);
  EXPECT_EQ(keyframes[1].revision, 1U);
  EXPECT_EQ(points_of(keyframes), (std::vector<Eigen::Vector3f>{{1, 3, 0}, {2, 3, 0}}));
  EXPECT_GE(memory_bytes(keyframes), 2 * sizeof(Keyframe) + 2 * sizeof(Eigen::Vector3f));
}

TEST(Features, AreAveragedInVoxelsOfTheirKind) {
  const Features features{{{0.1F, 0.1F, 0.1F}, {0.9F, 0.1F, 0.1F}},
                          {{0.1F, 0.1F, 0.1F}, {0.9F, 0.1F, 0.1F}}};
  const Features means = thinned(features, {0.5, 1.0});
  EXPECT_EQ(means.edges, features.edges);
  ASSERT_EQ(means.surfaces.size(), 1U);
  EXPECT_FLOAT_EQ(means.surfaces[0].x(), 0.5F);
}

TEST(FeatureMap, IsThatOfTheKeyframesNearTheLast) {
  std::vector<Keyframe> keyframes;
  for (const double x : {0.0, 30.0, 100.0}) {
    const Pose pose = make_pose(Eigen::Matrix3d::Identity(), {x, 0, 0});
    keyframes.push_back({from_seconds(x), pose, {{{1, 0, 0}}, {{0, 1, 0}}}, 0});
  }
  FeatureMap map({0.2, 0.4});
  map.follow(keyframes, from_seconds(100.0), {.radius_m = 50.0});
  EXPECT_EQ(map.size(), 2U);
  keyframes.pop_back();
  map.follow(keyframes, from_seconds(101.0), {.radius_m = 50.0});
  EXPECT_EQ(map.edges.size(), 2U);
  EXPECT_EQ(map.surfaces.size(), 2U);
}

}  // namespace
}  // namespace lidarena::map
