// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/odometry/arena_lio/plane_residuals.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "lidarena/base/random.hpp"

namespace lidarena::odometry::arena_lio {
namespace {

using Points = std::vector<Eigen::Vector3f>;

constexpr float kFloor = -1.35F;  // m, z; the sensor is at the origin

/// A floor of 4 x 4 m below the origin, with noise across it (m).
Points floor_points(double noise = 0.0, float z = kFloor) {
  SequentialRandom random(8, 1);
  Points points;
  for (int x = -60; x < 60; ++x) {
    for (int y = -60; y < 60; ++y) {
      points.emplace_back(static_cast<float>(x) / 30.0F, static_cast<float>(y) / 30.0F,
                          z + static_cast<float>(noise * random.normal()));
    }
  }
  return points;
}

/// The LiDAR's place for each of the points.
Points at_zero(const Points& points) { return Points(points.size(), Eigen::Vector3f::Zero()); }

map::LocalPlanes map_of(const Points& points) {
  map::LocalPlanes map({});
  map.insert(points, Eigen::Vector3f::Zero());
  return map;
}

/// Sum of w n n^T along z, of the first evaluation, or of a later one.
double weight(const map::LocalPlanes& map, const Eigen::Vector3f& point, double prior_sigma = 0.0,
              int evaluation = 1) {
  const Points points{point};
  const Config config;
  const Parallel parallel(1);
  const Points seen_from = at_zero(points);
  PlaneResiduals residuals(points, seen_from, map, prior_sigma, true, config, parallel);
  estimation::NormalEquations<estimation::kPointDof> sums;
  for (int i = 0; i < evaluation; ++i) sums = residuals({}, true);
  return sums.hessian(2, 2);
}

TEST(ArenaLioPlanes, TheResidualIsTheDistanceFromThePlaneOfTheCell) {
  const map::LocalPlanes map = map_of(floor_points());
  const Points points{{0.4F, 0.7F, kFloor + 0.01F}};
  const Config config;
  const Parallel parallel(1);
  const Points seen_from = at_zero(points);
  const auto sums = PlaneResiduals(points, seen_from, map, 0.0, true, config, parallel)({}, true);
  ASSERT_EQ(sums.count, 1U);
  const double kernel = 1.0 / std::pow(1.0 + 0.01 * 0.01 / (0.05 * 0.05), 2);
  EXPECT_NEAR(sums.hessian(2, 2), kernel, 1e-3);
  EXPECT_NEAR(std::abs(sums.gradient[2]), 0.01 * kernel, 1e-4);
  EXPECT_NEAR(sums.hessian(0, 0), 0.0, 1e-4) << "along the floor nothing is known";
}

TEST(ArenaLioPlanes, AThickPlaneCountsLess) {
  EXPECT_NEAR(weight(map_of(floor_points(0.01)), {0.4F, 0.7F, kFloor}), 1.0, 0.1)
      << "within the points' own noise of 2 cm";
  EXPECT_NEAR(weight(map_of(floor_points(0.04)), {0.4F, 0.7F, kFloor}), 0.25, 0.08);
}

TEST(ArenaLioPlanes, TheKernelNarrowsFromThePriorsUncertaintyToItsScale) {
  const map::LocalPlanes map = map_of(floor_points());
  const Eigen::Vector3f off(0.4F, 0.7F, kFloor + 0.04F);
  EXPECT_NEAR(weight(map, off, 0.0), std::pow(1.0 + 0.64, -2), 0.01);
  EXPECT_NEAR(weight(map, off, 1.0), 1.0, 0.01) << "1 m";
  EXPECT_NEAR(weight(map, off, 1.0, 3), std::pow(1.0 + 0.0625, -2), 0.01) << "0.16 m";
  EXPECT_NEAR(weight(map, off, 1.0, 6), std::pow(1.0 + 0.64, -2), 0.01) << "5 cm";
}

TEST(ArenaLioPlanes, WhereFinePlanesAreRareTheCoarseOnesServe) {
  // 20 points in 4 x 4 m: cells of 0.9 m have planes, those of 0.3 m have none.
  Points sparse;
  for (int i = 0; i < 20; ++i) {
    const auto x = static_cast<float>(i % 5);
    sparse.emplace_back(0.17F * x, 0.2F * static_cast<float>(i / 5), kFloor);
  }
  const map::LocalPlanes map = map_of(sparse);
  const Config config;
  const Parallel parallel(1);
  const Points seen_from = at_zero(sparse);
  PlaneResiduals residuals(sparse, seen_from, map, 0.0, true, config, parallel);
  EXPECT_GT(residuals({}, true).count, 5U);
  const map::LocalPlanes dense = map_of(floor_points());
  EXPECT_EQ(weight(dense, {0.4F, 0.7F, kFloor + 3.0F}), 0.0) << "3 m above";
}

TEST(ArenaLioPlanes, TheAgreementCountsThePointsOnTheirPlanes) {
  const map::LocalPlanes map = map_of(floor_points());
  const Points points{
      {0.4F, 0.7F, kFloor + 0.01F}, {0.4F, 0.6F, kFloor - 0.02F}, {0.3F, 0.6F, 9.0F}};
  const Config config;
  const Parallel parallel(1);
  const Points seen_from = at_zero(points);
  PlaneResiduals residuals(points, seen_from, map, 0.0, true, config, parallel);
  const auto here = residuals.agreement({});
  EXPECT_EQ(here.near_planes, 2U);
  EXPECT_EQ(here.on_planes, 2U);
  EXPECT_EQ(here.share(), 1.0) << "of those near planes";
  const Points seen_from_uncertain = at_zero(points);
  PlaneResiduals uncertain(points, seen_from_uncertain, map, 1.0, true, config, parallel);
  EXPECT_NEAR(uncertain.agreement({}).share(), 2.0 / 3.0, 1e-12) << "of all";
  estimation::InertialState moved;
  moved.position().z() = 0.045;
  EXPECT_EQ(residuals.agreement(moved).on_planes, 1U) << "one is now 5.5 cm above";
  EXPECT_EQ(PlaneResiduals({}, {}, map, 0.0, true, config, parallel).agreement({}).share(), 0.0);
}

TEST(ArenaLioPlanes, AWallHasTwoSides) {
  // 10 cm thick, seen from above and from below: one cell of the map holds points of both faces.
  constexpr float kBelow = -3.0F;  // m, z of the sensor
  map::LocalPlanes map = map_of(floor_points(0.0, kFloor + 0.05F));
  map.insert(floor_points(0.0, kFloor - 0.05F), Eigen::Vector3f(0.0F, 0.0F, kBelow));
  EXPECT_NEAR(weight(map, {0.4F, 0.7F, kFloor + 0.05F}), 1.0, 1e-3);
  estimation::InertialState below;
  below.position().z() = static_cast<double>(kBelow);
  const Points points{{0.4F, 0.7F, kFloor - 0.05F - kBelow}};
  const Config config;
  const Parallel parallel(1);
  const Points seen_from = at_zero(points);
  const auto sums =
      PlaneResiduals(points, seen_from, map, 0.0, true, config, parallel)(below, true);
  EXPECT_EQ(sums.count, 1U);
  EXPECT_NEAR(sums.gradient[2], 0.0, 1e-3);
  EXPECT_NEAR(sums.hessian(2, 2), 1.0, 1e-3);

  // Seen by a second LiDAR, which is below while the first one is above.
  const Points lower{{0.4F, 0.7F, kFloor - 0.05F}};
  const Points lower_lidar{{0.0F, 0.0F, kBelow}};
  const auto by_second =
      PlaneResiduals(lower, lower_lidar, map, 0.0, true, config, parallel)({}, true);
  EXPECT_EQ(by_second.count, 1U);
  EXPECT_NEAR(by_second.gradient[2], 0.0, 1e-3);
}

TEST(ArenaLioPlanes, ExtrinsicsAreMovedOnlyIfTheyAreEstimated) {
  const map::LocalPlanes map = map_of(floor_points());
  const Points points{{0.5F, 0.3F, kFloor}};
  const Parallel parallel(1);
  const auto sums = [&](bool extrinsics) {
    const Config config;
    const Points seen_from = at_zero(points);
    return PlaneResiduals(points, seen_from, map, 0.0, extrinsics, config, parallel)({}, true)
        .hessian;
  };
  EXPECT_EQ(sums(false).rightCols<6>().norm(), 0.0);
  EXPECT_GT(sums(true).diagonal().tail<6>().maxCoeff(), 0.1);
}

}  // namespace
}  // namespace lidarena::odometry::arena_lio
