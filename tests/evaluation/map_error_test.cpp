// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/evaluation/map/map_error.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numeric>

#include "flights.hpp"
#include "meshes.hpp"

namespace lidarena::evaluation {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

constexpr double kSingle = 2e-6;  // float positions within 10 m, and the ray caster's precision

/// Points over the middle 8 x 8 m of the plane z = 0 with normal noise along z, so that the nearest
/// point of the plane is the vertical projection.
std::vector<Vector3f> noisy_plane(std::size_t count, double sigma) {
  SequentialRandom random(21);
  std::vector<Vector3f> points(count);
  for (Vector3f& p : points) {
    p = Vector3d(random.uniform(-4, 4), random.uniform(-4, 4), sigma * random.normal())
            .cast<float>();
  }
  return points;
}

TEST(MapError, OfNoisyPointsOnAPlaneIsTheNoise) {
  const double sigma = 0.02;
  const std::size_t n = 100000;
  const world::World world(meshes::plane(10.0));
  const MapError e = map_error(noisy_plane(n, sigma), Pose::Identity(), world, Parallel(1));
  EXPECT_EQ(e.points, n);
  // standard error of the RMSE of n normals is sigma / sqrt(2 n); of quantiles of |normal|, sqrt(p
  // (1 - p) / n) / density; tolerance four times these
  const double root = std::sqrt(static_cast<double>(n));
  EXPECT_NEAR(e.distance_m.rmse, sigma, 4.0 * sigma / (std::sqrt(2.0) * root));
  EXPECT_NEAR(e.distance_m.median, 0.67449 * sigma, 4.0 * 0.787 * sigma / root);
  EXPECT_NEAR(e.distance_m.p95, 1.95996 * sigma, 4.0 * 1.865 * sigma / root);
  EXPECT_NEAR(e.distance_m.p99, 2.57583 * sigma, 4.0 * 3.440 * sigma / root);
  EXPECT_EQ(e.inliers, n);  // 20 cm are ten sigmas
  EXPECT_DOUBLE_EQ(e.rmse_inliers_m.value(), e.distance_m.rmse);
  EXPECT_EQ(e.outliers_percent, 0.0);
  EXPECT_EQ(std::accumulate(e.histogram.counts.begin(), e.histogram.counts.end(), std::uint64_t{0}),
            n);
  const double first_bin = static_cast<double>(e.histogram.counts[0]) / static_cast<double>(n);
  EXPECT_NEAR(first_bin, std::erf(0.5 / std::sqrt(2.0)), 4.0 * 0.486 / root);  // |z| < sigma / 2
}

TEST(MapError, MeasuresToTheSurfaceNotToItsCorners) {
  // Noise-free points on a plane of two triangles: vertices are meters away, the surface is not.
  const world::World world(meshes::plane(10.0));
  const MapError e = map_error(noisy_plane(1000, 0.0), Pose::Identity(), world, Parallel(1));
  EXPECT_LT(e.distance_m.max, kSingle);
}

TEST(MapError, OfPointsAroundABoxIsTheDistanceToFaceEdgeAndCorner) {
  const world::World world(meshes::box(Vector3d(1, 2, 3)));  // half sizes
  const std::vector<Vector3f> points{{0, 0, 3.1F},           // face
                                     {1.03F, 2.04F, 0},      // edge: 3-4-5
                                     {1.1F, 2.2F, 3.2F},     // corner: 1-2-2
                                     {0.5F, 0.0F, 0.0F}};    // inside: nearest face x = 1
  std::vector<float> distances;
  map_error(points, Pose::Identity(), world, Parallel(1), &distances);
  const std::vector<double> expected{0.1, 0.05, 0.3, 0.5};
  for (std::size_t i = 0; i < points.size(); ++i) {
    EXPECT_NEAR(distances[i], expected[i], kSingle) << "point " << i;
  }
}

TEST(MapError, PointsTwentyFiveCentimetersOffAreAllOutliers) {
  const world::World world(meshes::plane(10.0));
  const Pose lifted = flights::level({0, 0, 0.25});
  const MapError e = map_error(noisy_plane(1000, 0.0), lifted, world, Parallel(1));
  EXPECT_EQ(e.outliers_percent, 100.0);
  EXPECT_EQ(e.inliers, 0U);
  EXPECT_FALSE(e.rmse_inliers_m);
  EXPECT_NEAR(e.distance_m.rmse, 0.25, kSingle);
  EXPECT_EQ(std::accumulate(e.histogram.counts.begin(), e.histogram.counts.end(), std::uint64_t{0}),
            0U);
}

TEST(MapError, AMapInAnotherFrameIsBroughtBackByItsAlignment) {
  SequentialRandom random(22);
  const world::World world(meshes::box(Vector3d(3, 4, 2)));
  const Pose mesh_from_map = flights::random_pose(random, 3.0);
  std::vector<Vector3f> map;
  for (int i = 0; i < 2000; ++i) {
    const Vector3d on_wall(3.0, random.uniform(-4, 4), random.uniform(-2, 2));
    map.push_back((mesh_from_map.inverse() * on_wall).cast<float>());
  }
  EXPECT_LT(map_error(map, mesh_from_map, world, Parallel(1)).distance_m.max, 2.0 * kSingle);
  EXPECT_GT(map_error(map, Pose::Identity(), world, Parallel(1)).distance_m.max, 0.5);
}

TEST(MapError, PointsThatAreNotFiniteAreCountedAndLeftOut) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const float inf = std::numeric_limits<float>::infinity();
  const world::World world(meshes::plane(10.0));
  const std::vector<Vector3f> map{{0, 0, 0.1F}, {nan, 0, 0}, {0, 0, 0.1F}, {0, -inf, 0}};
  std::vector<float> distances;
  const MapError e = map_error(map, Pose::Identity(), world, Parallel(1), &distances);
  EXPECT_EQ(e.points, 2U);
  EXPECT_EQ(e.invalid, 2U);
  EXPECT_NEAR(e.distance_m.rmse, 0.1, kSingle);
  ASSERT_EQ(distances.size(), 4U);
  EXPECT_TRUE(std::isnan(distances[1]));
  EXPECT_TRUE(std::isnan(distances[3]));
  EXPECT_NEAR(distances[2], 0.1, kSingle);
}

TEST(MapError, OfAnEmptyMapHasNoPoints) {
  const world::World world(meshes::plane(10.0));
  const MapError e = map_error({}, Pose::Identity(), world, Parallel(1));
  EXPECT_EQ(e.points, 0U);
  EXPECT_EQ(e.distance_m.count, 0U);
  EXPECT_FALSE(e.outliers_percent);
}

TEST(MapError, IsTheSameBitsOnOneTwoAndFiveThreads) {
  const world::World world(meshes::box(Vector3d(4, 4, 0.1)));
  const std::vector<Vector3f> map = noisy_plane(300000, 0.15);  // more than a chunk
  const MapError one = map_error(map, Pose::Identity(), world, Parallel(1));
  for (const int threads : {2, 5}) {
    const MapError more = map_error(map, Pose::Identity(), world, Parallel(threads));
    EXPECT_EQ(one.distance_m.rmse, more.distance_m.rmse);
    EXPECT_EQ(one.distance_m.mean, more.distance_m.mean);
    EXPECT_EQ(one.distance_m.p99, more.distance_m.p99);
    EXPECT_EQ(one.rmse_inliers_m, more.rmse_inliers_m);
    EXPECT_EQ(one.histogram.counts, more.histogram.counts);
  }
}

TEST(MapError, BinsAreCentimetersAndTwentyCentimetersAreStillIn) {
  const std::vector<double> distances{0.0, 0.0099, 0.0101, 0.1999, 0.20, 0.2001, 5.0};
  const MapError e = summarize_distances(distances);
  EXPECT_EQ(e.histogram.counts[0], 2U);
  EXPECT_EQ(e.histogram.counts[1], 1U);
  EXPECT_EQ(e.histogram.counts[19], 2U);
  EXPECT_EQ(e.inliers, 5U);
  EXPECT_DOUBLE_EQ(e.outliers_percent.value(), 100.0 * 2.0 / 7.0);
}

}  // namespace
}  // namespace lidarena::evaluation
