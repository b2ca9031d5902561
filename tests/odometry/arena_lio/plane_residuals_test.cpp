// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/odometry/arena_lio/plane_residuals.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "lidarena/base/random.hpp"
#include "lidarena/base/so3.hpp"

namespace lidarena::odometry::arena_lio {
namespace {

using FiveNeighbors = std::array<map::Neighbor, kNeighbors>;

/// A cross with arms `length` and `width` (m) in a tilted plane, with noise `sigma` across it.
FiveNeighbors cross(double length, double width, double sigma, SequentialRandom& random) {
  const Eigen::Matrix3d turn = so3::exp({0.4, -0.3, 0.9});
  FiveNeighbors points;
  const double arms[5][2] = {{0, 0}, {length, 0}, {-length, 0}, {0, width}, {0, -width}};
  for (std::size_t i = 0; i < 5; ++i) {
    const Eigen::Vector3d at(arms[i][0], arms[i][1], 5.0 + sigma * random.normal());
    points[i].point = (turn * at).cast<float>();
  }
  return points;
}

TEST(ArenaLioPlanes, TheVarianceIsThatOfManyFits) {
  SequentialRandom random(12, 1);
  constexpr double kSigma = 0.01;
  constexpr double kLength = 0.3;
  constexpr int kFits = 4000;
  const Eigen::Matrix3d turn = so3::exp({0.4, -0.3, 0.9});
  for (const double width : {0.08, 0.15, 0.25}) {
    // In the direction that is determined worst, at the distance of the farthest point.
    const Eigen::Vector3d end = turn * Eigen::Vector3d(0.0, kLength, 5.0);
    double squares = 0.0;
    for (int i = 0; i < kFits; ++i) {
      const auto plane =
          estimation::fit_plane(map::columns_of(cross(kLength, width, kSigma, random)),
                                estimation::PlaneFit::kPrincipal, 0.1);
      ASSERT_TRUE(plane.has_value());
      squares += std::pow(plane->normal.dot(end) + plane->offset, 2);
    }
    const FiveNeighbors exact = cross(kLength, width, 0.0, random);
    const auto plane =
        estimation::fit_plane(map::columns_of(exact), estimation::PlaneFit::kPrincipal, 0.1);
    const double predicted_variance = plane_variance(exact, *plane, kSigma * kSigma);
    const double tilt = kSigma * kSigma / (2.0 * width * width);
    EXPECT_NEAR(predicted_variance, kSigma * kSigma / 5.0 + tilt * kLength * kLength,
                1e-3 * predicted_variance);
    // 4000 squares give a variance to 2.2 %; the rest is the second order of the fit.
    EXPECT_NEAR(squares / kFits, predicted_variance, 0.1 * predicted_variance) << "width " << width;
  }
}

TEST(ArenaLioPlanes, OfPointsOnALineNothingIsKnown) {
  SequentialRandom random(13, 1);
  const FiveNeighbors line = cross(0.3, 0.0, 0.0, random);
  const auto plane =
      estimation::fit_plane(map::columns_of(line), estimation::PlaneFit::kPrincipal, 0.1);
  ASSERT_TRUE(plane.has_value());
  EXPECT_GT(plane_variance(line, *plane, 1e-3), 1.0) << "m^2; large but finite";
  EXPECT_LT(plane_variance(line, *plane, 1e-3), 1e3);
}

TEST(ArenaLioPlanes, ResidualsAreGatedByRangeAndKeptUntilTheNextSearch) {
  map::KdTree map;
  for (int x = -20; x <= 20; ++x) {
    for (int y = -20; y <= 20; ++y) {
      map.insert({0.2F * static_cast<float>(x), 0.2F * static_cast<float>(y), 0.0F});
    }
  }
  const std::vector<Eigen::Vector3f> points{{0.05F, 0.03F, 1.0F}};  // 1 m below: gate 0.111 m
  const Config config;
  const Parallel parallel(1);
  PlaneResiduals residuals(points, map, config, parallel);
  estimation::InertialState state;
  state.position().z() = -0.9;
  const auto near = residuals(state, true);
  ASSERT_EQ(near.count, 1U);
  EXPECT_EQ(residuals.near_planes(), 1U);
  state.position().z() = -0.88;
  EXPECT_EQ(residuals(state, false).count, 0U) << "0.12 m away";
  EXPECT_EQ(residuals.near_planes(), 1U) << "near the plane, but off it";
  state.position().z() = -0.95;
  EXPECT_EQ(residuals(state, false).count, 0U) << "out until the next search";
  EXPECT_EQ(residuals(state, true).count, 1U);
}

TEST(ArenaLioPlanes, UncertainPlanesAndThoseThroughTheOriginAreUsedWithTheirWeights) {
  // Points on the floor z = 0, through the origin; five along a line say nothing about its tilt.
  map::KdTree map;
  for (int i = 0; i < 5; ++i) {
    const float x = 0.2F * static_cast<float>(i);
    map.insert({x, 0.0F, 0.0F});
    map.insert({x, 20.0F, 0.0F});
    map.insert({x, 20.2F, 0.0F});
    map.insert({x, 19.8F, 0.0F});
  }
  const Config config;
  const Parallel parallel(1);
  const estimation::InertialState state;
  const auto weight = [&](const Eigen::Vector3f& point) {
    const std::vector<Eigen::Vector3f> points{point};
    const auto sum = PlaneResiduals(points, map, config, parallel)(state, true);
    return sum.hessian.topLeftCorner<3, 3>().trace();  // of w n n^T
  };
  EXPECT_GT(weight({0.4F, 20.0F, 0.01F}), 0.3);
  EXPECT_GT(weight({0.4F, 20.0F, 0.01F}), 100.0 * weight({0.4F, 0.0F, 0.01F}));
  EXPECT_EQ(weight({0.4F, 10.0F, 0.01F}), 0.0) << "no map within 2.2 m";
}

TEST(ArenaLioPlanes, ExtrinsicsAreMovedOnlyIfTheyAreEstimated) {
  map::KdTree map;
  for (int i = 0; i < 25; ++i)
    map.insert({0.2F * static_cast<float>(i / 5), 0.2F * static_cast<float>(i % 5), -1.0F});
  const std::vector<Eigen::Vector3f> points{{0.5F, 0.3F, -1.0F}};
  const Parallel parallel(1);
  const auto sums = [&](bool extrinsics) {
    const Config config{.estimate_extrinsics = extrinsics};
    return PlaneResiduals(points, map, config, parallel)({}, true).hessian;
  };
  EXPECT_EQ(sums(false).rightCols<6>().norm(), 0.0);
  EXPECT_GT(sums(true).diagonal().tail<6>().maxCoeff(), 0.1);
}

}  // namespace
}  // namespace lidarena::odometry::arena_lio
