// SPDX-License-Identifier: BSD-3-Clause
// Voxel weights, signed distances and double walls, on maps whose metrics have a closed form.
#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "flights.hpp"
#include "lidarena/evaluation/map/ghosting.hpp"
#include "lidarena/evaluation/map/map_error.hpp"
#include "lidarena/evaluation/map/signed_distance.hpp"
#include "lidarena/evaluation/map/voxel_error.hpp"
#include "meshes.hpp"
#include "tests/evaluation/two_threads.hpp"

namespace lidarena::evaluation {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

struct Scored {
  std::vector<Vector3f> map;
  world::World world;
  MortonOrder order = morton_order(map, kTwoThreads);
  std::vector<PointScore> scores = score_points(map, order, Pose::Identity(), world, kTwoThreads);
  MapError error = map_error(order, scores, map.size());
};

std::vector<Vector3f> points_off_floor(std::size_t count, double half,
                                       const std::function<double(SequentialRandom&)>& height) {
  SequentialRandom random(61);
  std::vector<Vector3f> points(count);
  for (Vector3f& p : points) {
    const double x = random.uniform(-half, half);
    const double y = random.uniform(-half, half);
    p = Vector3d(x, y, height(random)).cast<float>();
  }
  return points;
}

TEST(MortonOrder, HoldsEachFinitePointOnceAndTheSameOnAnyNumberOfThreads) {
  SequentialRandom random(62);
  std::vector<Vector3f> points(200000);
  for (Vector3f& p : points) {
    p = 5.0F * Vector3d(random.normal(), random.normal(), random.normal()).cast<float>();
  }
  points[17].x() = std::numeric_limits<float>::quiet_NaN();
  const MortonOrder one = morton_order(points, Parallel(1));
  const MortonOrder three = morton_order(points, Parallel(3));
  ASSERT_EQ(one.entries.size(), points.size() - 1);
  std::vector<bool> seen(points.size(), false);
  double length = 0.0;
  for (std::size_t k = 0; k < one.entries.size(); ++k) {
    const std::uint32_t i = one.entries[k].index;
    ASSERT_EQ(i, three.entries[k].index);
    ASSERT_FALSE(seen[i]);
    seen[i] = true;
    if (k > 0) length += double{(points[i] - points[one.entries[k - 1].index]).norm()};
  }
  // in the original order, neighbors are 11 m apart
  EXPECT_LT(length / static_cast<double>(points.size()), 1.0);
}

TEST(VoxelError, CountsAPlaceOnceHoweverManyPointsLieThere) {
  // one cube with 999 points on the floor, one with a single point 10 cm above it
  std::vector<Vector3f> map(999, Vector3f(0.01F, 0.01F, 0.0F));
  map.emplace_back(1.01F, 0.01F, 0.10F);
  const Scored s{map, world::World(meshes::plane(10.0))};
  const VoxelError e = voxel_error(s.order, s.scores);
  EXPECT_EQ(e.voxels, 2U);
  EXPECT_NEAR(e.rms_m.rmse, 0.10 / std::sqrt(2.0), 1e-6);
  EXPECT_NEAR(s.error.distance_m.rmse, 0.10 / std::sqrt(1000.0), 1e-6);
}

TEST(VoxelError, IsTheRmseWhereEachCubeHoldsOnePoint) {
  std::vector<Vector3f> map;
  SequentialRandom random(63);
  for (int i = 0; i < 40; ++i) {
    for (int j = 0; j < 40; ++j) {
      map.emplace_back(0.1F * static_cast<float>(i) + 0.02F, 0.1F * static_cast<float>(j) + 0.02F,
                       0.3F * static_cast<float>(random.uniform()));
    }
  }
  const Scored s{map, world::World(meshes::plane(10.0))};
  const VoxelError e = voxel_error(s.order, s.scores);
  EXPECT_EQ(e.voxels, map.size());
  EXPECT_NEAR(e.rms_m.rmse, s.error.distance_m.rmse, 1e-12);
  EXPECT_NEAR(e.outliers_percent, s.error.outliers_percent.value(), 1e-9);
}

TEST(SignedDistance, OfABiasedMapIsTheBias) {
  const double bias = 0.03, sigma = 0.01;
  const std::size_t n = 50000;
  const Scored s{
      points_off_floor(n, 4.0, [&](SequentialRandom& r) { return bias + sigma * r.normal(); }),
      world::World(meshes::plane(10.0))};
  for (const FreeSide side : {FreeSide::kFront, FreeSide::kBack}) {
    const double sign = side == FreeSide::kFront ? 1.0 : -1.0;
    const SignedDistance d = signed_distance(s.scores, std::vector(2, side));
    ASSERT_EQ(d.points, n);
    // four standard errors; those of the 5 % quantile are sqrt(p (1 - p) / n) / density
    const double root = std::sqrt(static_cast<double>(n));
    EXPECT_NEAR(d.mean_m, sign * bias, 4.0 * sigma / root);
    EXPECT_NEAR(d.median_m, sign * bias, 4.0 * 1.2533 * sigma / root);
    EXPECT_NEAR(d.p5_m, sign * bias - 1.64485 * sigma, 4.0 * 2.113 * sigma / root);
    EXPECT_NEAR(d.p95_m, sign * bias + 1.64485 * sigma, 4.0 * 2.113 * sigma / root);
    const double behind = side == FreeSide::kFront ? 0.135 : 99.865;  // three sigmas
    EXPECT_NEAR(d.behind_percent, behind, 4.0 * 100.0 * 0.0367 / root);
    EXPECT_EQ(
        std::accumulate(d.histogram.counts.begin(), d.histogram.counts.end(), std::uint64_t{0}), n);
  }
}

TEST(SignedDistance, BinsStartAtMinusTwentyCentimetersAndTheRestIsCountedApart) {
  const std::vector<Vector3f> map{{0, 0, -0.195F}, {0, 0, 0.005F}, {0, 0, 0.195F},
                                  {0, 0, -0.5F},   {0, 0, 0.3F},   {0, 0, 0.4F}};
  const Scored s{map, world::World(meshes::plane(10.0))};
  const SignedDistance d = signed_distance(s.scores, std::vector(2, FreeSide::kFront));
  EXPECT_EQ(d.histogram.counts[0], 1U);
  EXPECT_EQ(d.histogram.counts[20], 1U);
  EXPECT_EQ(d.histogram.counts[39], 1U);
  EXPECT_EQ(d.histogram.below, 1U);
  EXPECT_EQ(d.histogram.above, 2U);
}

TEST(SignedDistance, BesideAnEdgeOrWhereNoRayFellThereIsNoSign) {
  // beyond the floor's border, 45 degrees and 80 degrees off the normal; one point over the floor
  const std::vector<Vector3f> map{{5.1F, 0, 0.1F}, {5.567F, 0, 0.1F}, {0, 0, 0.1F}};
  const Scored s{map, world::World(meshes::plane(10.0))};
  EXPECT_EQ(signed_distance(s.scores, std::vector(2, FreeSide::kFront)).points, 2U);
  const SignedDistance unknown = signed_distance(s.scores, std::vector(2, FreeSide::kUnknown));
  EXPECT_EQ(unknown.points, 0U);
  EXPECT_EQ(unknown.without, 3U);
}

TEST(Ghosting, ThicknessOfANoisyFloorIsItsQuantileRange) {
  const double sigma = 0.02;
  const Scored s{
      points_off_floor(200000, 2.0, [&](SequentialRandom& r) { return sigma * r.normal(); }),
      world::World(meshes::plane(10.0))};
  const Ghosting g = ghosting(s.scores, s.world, kTwoThreads);
  EXPECT_EQ(g.patches, 400U);  // 4 x 4 m in squares of 20 cm, 500 points each
  // 2 x 1.645 sigma. A quantile of 500 values has a standard error of 2.11 sigma / sqrt(500), hence
  // the mean range of 400 patches 0.007 sigma; and quantiles of 500 values are biased by -0.7 %
  // (Blom)
  EXPECT_NEAR(g.thickness_m.mean, 3.2897 * sigma, 0.05 * sigma);
  EXPECT_EQ(g.double_patches, 0U);  // no single sheet is judged double
}

TEST(Ghosting,
     ATenPercentDoubleWallAtFifteenCentimetersIsSeenThoughTheTwentyCentimeterRuleMissesIt) {
  const double sigma = 0.02;
  const Scored s{points_off_floor(200000, 4.0,
                                  [&](SequentialRandom& r) {
                                    const double second = r.uniform() < 0.1 ? 0.15 : 0.0;
                                    return second + sigma * r.normal();
                                  }),
                 world::World(meshes::plane(10.0))};
  // 10 % of P(z > 2.5) are beyond 20 cm: 0.06 %
  EXPECT_NEAR(s.error.outliers_percent.value(), 0.062, 0.03);
  // sqrt(sigma^2 + 0.1 x 15^2): not more than for a bad sensor
  EXPECT_NEAR(s.error.distance_m.rmse, std::hypot(sigma, 0.15 * std::sqrt(0.1)), 0.001);
  const Ghosting g = ghosting(s.scores, s.world, kTwoThreads);
  EXPECT_EQ(g.patches, 1600U);
  // a patch of 125 points has 12.5 +- 3.4 ghost points; fewer than 7 are less than 5 % (3 of 100
  // patches), and with few ghost points one or two in the valley are too many
  EXPECT_GT(g.double_percent, 85.0);
  EXPECT_NEAR(g.median_separation_m.value(), 0.15, 0.005);
  EXPECT_GT(g.thickness_m.median, 0.14);
}

TEST(Ghosting, WindingDoesNotMatter) {
  world::TriangleMesh mixed = meshes::plane(10.0);
  std::swap(mixed.triangles[1][1], mixed.triangles[1][2]);
  const auto map =
      points_off_floor(100000, 4.0, [](SequentialRandom& r) { return 0.1 + 0.01 * r.normal(); });
  const Scored straight{map, world::World(meshes::plane(10.0))};
  const Scored wound{map, world::World(mixed)};
  const Ghosting expected = ghosting(straight.scores, straight.world, kTwoThreads);
  const Ghosting found = ghosting(wound.scores, wound.world, kTwoThreads);
  EXPECT_EQ(expected.double_patches, 0U);
  EXPECT_EQ(found.double_patches, 0U);
  EXPECT_EQ(found.thickness_m.mean, expected.thickness_m.mean);
}

/// Share of patches of `count` heights that are judged to have two sheets.
double share_of_two(std::size_t count, const std::function<double(SequentialRandom&)>& height) {
  SequentialRandom random(64);
  constexpr int kTrials = 2000;
  int taken = 0;
  for (int trial = 0; trial < kTrials; ++trial) {
    std::vector<float> heights(count);
    for (float& h : heights) h = static_cast<float>(height(random));
    std::sort(heights.begin(), heights.end());
    if (split_sheets(heights).are_two) ++taken;
  }
  return static_cast<double>(taken) / kTrials;
}

TEST(Ghosting, OneSheetIsSeldomTakenForTwoAndTwoAreSeldomTakenForOne) {
  const auto normal = [](SequentialRandom& r) { return r.normal(); };
  const auto laplace = [](SequentialRandom& r) {
    const double side = r.uniform() < 0.5 ? -1.0 : 1.0;
    return -side * std::log(1.0 - r.uniform());
  };
  const auto two = [](SequentialRandom& r) { return r.normal() + (r.uniform() < 0.5 ? 5.0 : 0.0); };
  const auto merged = [](SequentialRandom& r) {
    return r.normal() + (r.uniform() < 0.5 ? 2.0 : 0.0);  // one peak: a wall twice as thick
  };
  for (const std::size_t count : {50U, 125U, 500U}) {
    EXPECT_LT(share_of_two(count, normal), 0.01) << count;
    EXPECT_LT(share_of_two(count, laplace), 0.01) << count;
    EXPECT_LT(share_of_two(count, merged), 0.01) << count;
    EXPECT_GT(share_of_two(count, two), 0.95) << count;
  }
  const auto constant = [](SequentialRandom&) { return 0.1; };
  EXPECT_EQ(share_of_two(100, constant), 0.0);
}

TEST(Ghosting, IsTheSameOnAnyNumberOfThreads) {
  const Scored s{points_off_floor(200000, 4.0,
                                  [](SequentialRandom& r) {
                                    return (r.uniform() < 0.2 ? 0.1 : 0.0) + 0.02 * r.normal();
                                  }),
                 world::World(meshes::plane(10.0))};
  const Ghosting one = ghosting(s.scores, s.world, Parallel(1));
  const Ghosting five = ghosting(s.scores, s.world, Parallel(5));
  EXPECT_EQ(one.thickness_m.rmse, five.thickness_m.rmse);
  EXPECT_EQ(one.double_patches, five.double_patches);
  EXPECT_EQ(one.median_separation_m, five.median_separation_m);
}

}  // namespace
}  // namespace lidarena::evaluation
