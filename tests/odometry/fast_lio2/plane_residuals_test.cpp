// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/odometry/fast_lio2/plane_residuals.hpp"

#include <gtest/gtest.h>

namespace lidarena::odometry::fast_lio2 {
namespace {

/// A floor at this height, 8 m wide, with points 0.2 m apart.
map::KdTree floor_at(float z) {
  map::KdTree map;
  for (int x = -20; x <= 20; ++x)
    for (int y = -20; y <= 20; ++y)
      map.insert({0.2F * static_cast<float>(x), 0.2F * static_cast<float>(y), z});
  return map;
}

std::size_t matches_of(const std::vector<Eigen::Vector3f>& points, const map::KdTree& map) {
  const Parallel parallel(1);
  return PlaneResiduals(points, map, false, parallel)({}, true).count;
}

TEST(FastLio2Planes, APointOffItsPlaneStaysOutUntilTheNextSearch) {
  const map::KdTree map = floor_at(-1.0F);
  const std::vector<Eigen::Vector3f> points{{0.05F, 0.03F, -1.0F}};  // gate at 1 m: 0.111 m
  const Parallel parallel(1);
  PlaneResiduals residuals(points, map, false, parallel);
  estimation::InertialState state;
  state.position().z() = 0.1;
  const auto near = residuals(state, true);
  ASSERT_EQ(near.count, 1U);
  EXPECT_NEAR(near.cost, 0.5 * 0.1 * 0.1, 1e-6);
  state.position().z() = 0.12;
  EXPECT_EQ(residuals(state, false).count, 0U) << "0.12 m away";
  state.position().z() = 0.05;
  EXPECT_EQ(residuals(state, false).count, 0U) << "out until the next search";
  EXPECT_EQ(residuals(state, true).count, 1U);
}

TEST(FastLio2Planes, ThroughTheOriginNoneIsFound) {
  EXPECT_EQ(matches_of({{0.05F, 0.03F, -1.02F}}, floor_at(-1.0F)), 1U);
  EXPECT_EQ(matches_of({{0.05F, 0.03F, 0.02F}, {1.05F, 1.03F, 0.02F}}, floor_at(0.0F)), 0U)
      << "a fault of the program";
}

TEST(FastLio2Planes, TheFarthestOfTheFiveNeighborsIsNear) {
  // Above the floor's middle the five nearest are about as far as the height above it.
  EXPECT_EQ(matches_of({{0.0F, 0.0F, 1.0F}}, floor_at(-1.3F)), 0U) << "2.3 m: the square exceeds 5";
  EXPECT_EQ(matches_of({{4.0F + 2.0F, 0.0F, -20.0F}}, floor_at(-20.0F)), 1U) << "beside it, 2 m";
  EXPECT_EQ(matches_of({{4.0F + 2.3F, 0.0F, -20.0F}}, floor_at(-20.0F)), 0U) << "2.3 m";
}

TEST(FastLio2Planes, ThickNeighborhoodsAndSmallMapsHaveNone) {
  map::KdTree thick;
  for (int i = 0; i < 5; ++i)
    thick.insert({0.2F * static_cast<float>(i % 2), 0.2F * static_cast<float>(i / 2),
                  -2.0F + 0.3F * static_cast<float>(i % 3)});
  EXPECT_EQ(matches_of({{0.1F, 0.1F, -2.0F}}, thick), 0U);
  map::KdTree four;
  for (int i = 0; i < 4; ++i) four.insert({0.2F * static_cast<float>(i), 0.0F, -2.0F});
  EXPECT_EQ(matches_of({{0.1F, 0.1F, -2.0F}}, four), 0U);
}

TEST(FastLio2Planes, ExtrinsicsAreMovedOnlyIfTheyAreEstimated) {
  const map::KdTree map = floor_at(-1.0F);
  const std::vector<Eigen::Vector3f> points{{0.5F, 0.3F, -1.0F}};
  const Parallel parallel(1);
  const auto sums = [&](bool extrinsics) {
    return PlaneResiduals(points, map, extrinsics, parallel)({}, true).hessian;
  };
  EXPECT_EQ(sums(false).rightCols<6>().norm(), 0.0);
  EXPECT_GT(sums(true).diagonal().tail<6>().maxCoeff(), 0.1);
}

}  // namespace
}  // namespace lidarena::odometry::fast_lio2
