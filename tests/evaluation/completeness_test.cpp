// SPDX-License-Identifier: BSD-3-Clause
// The surface of a mesh that rays hit, and how much of it a map has.
#include "lidarena/evaluation/map/completeness.hpp"
#include "tests/listed_sources.hpp"

#include <gtest/gtest.h>
#include "tests/evaluation/two_threads.hpp"

#include <cmath>
#include <deque>

#include "flights.hpp"
#include "meshes.hpp"

namespace lidarena::evaluation {
namespace {

using namespace std::chrono_literals;
using Eigen::Vector3d;
using Eigen::Vector3f;
using listed::Truths;

/// Hits on the floor z = 0 for x in [0, length], |y| < 1, one per centimeter, from above.
Truths hits_on_floor(double length) {
  Truths truths;
  ScanTruth scan{"front", Time(0), {}};
  for (double x = 0.005; x < length; x += 0.01) {
    for (double y = -0.995; y < 1.0; y += 0.01) {
      scan.points.push_back({Vector3d(x, y, 0).cast<float>(), 1.0F, Vector3f(0, 0, 1), 0});
    }
  }
  truths.scans.push_back(std::move(scan));
  return truths;
}

TEST(PointGrid, FindsTheNearestWithinReachAsALookAtAllPointsDoes) {
  SequentialRandom random(81);
  std::vector<Vector3f> points(3000);
  for (Vector3f& p : points) {
    const double x = random.uniform(-1, 1), y = random.uniform(-1, 1);
    p = Vector3d(x, y, random.uniform(-1, 1)).cast<float>();
  }
  points[7].x() = std::numeric_limits<float>::quiet_NaN();
  for (const double cell : {0.05, 0.2, 0.5}) {
    const PointGrid grid(points, cell, 0.2, kTwoThreads);
    int none = 0;
    for (int i = 0; i < 500; ++i) {
      const double x = random.uniform(-1.3, 1.3), y = random.uniform(-1.3, 1.3);
      const Vector3f query = Vector3d(x, y, random.uniform(-1.3, 1.3)).cast<float>();
      float expected = std::numeric_limits<float>::infinity();
      for (const Vector3f& p : points) {
        if (p.allFinite()) expected = std::min(expected, (p - query).norm());
      }
      if (expected > 0.2F) {
        expected = std::numeric_limits<float>::infinity();
        ++none;
      }
      ASSERT_EQ(grid.nearest(query), expected);
      ASSERT_EQ(grid.is_near(query), std::isfinite(expected));
    }
    EXPECT_GT(none, 50);
  }
}

TEST(ObservedSurface, FreeSpaceIsWhereTheRaysCameFromHoweverTrianglesAreWound) {
  for (const bool turned : {false, true}) {
    world::TriangleMesh mesh = meshes::plane(10.0);
    if (turned) {
      for (world::Triangle& t : mesh.triangles) std::swap(t[1], t[2]);
    }
    const world::World world(mesh);
    Truths truths = hits_on_floor(2.0);
    truths.scans[0].points.push_back({Vector3f(0, 0, 0.5F), 1.0F, Vector3f(0, 0, 1), 0});
    const ObservedSurface seen = observe(truths, world, kTwoThreads);
    EXPECT_EQ(seen.returns, 200U * 200U + 1U);
    EXPECT_EQ(seen.off_mesh, 1U);  // the added point is not on the floor
    EXPECT_EQ(seen.hits.size(), 100U * 100U);
    for (const FreeSide side : seen.free_side) {
      EXPECT_EQ(side, turned ? FreeSide::kBack : FreeSide::kFront);
    }
  }
}

TEST(ObservedSurface, ATriangleHitFromBothSidesOrNotAtAllHasNoFreeSide) {
  const world::World world(meshes::plane(10.0));
  Truths truths = hits_on_floor(2.0);
  // the second triangle is that with y > x: flip the side of half of its hits
  std::size_t turned = 0;
  for (PointTruth& hit : truths.scans[0].points) {
    if (hit.position.y() > hit.position.x() && turned++ % 2 == 0) hit.normal = -hit.normal;
  }
  const ObservedSurface both = observe(truths, world, kTwoThreads);
  EXPECT_EQ(both.free_side[0], FreeSide::kFront);
  EXPECT_EQ(both.free_side[1], FreeSide::kUnknown);
  Truths none;
  EXPECT_EQ(observe(none, world, kTwoThreads).free_side[0], FreeSide::kUnknown);
}

TEST(ObservedSurface, FromNoisyReturnsIsWhereTheirRaysMeetTheMesh) {
  const world::World world(meshes::box(Vector3d(7, 8, 4)));
  const Trajectory truth = flights::sample(flights::tour, 50ms, 5s);
  const Pose body_from_lidar = make_pose(so3::exp({0.3, -0.2, 1.1}), Vector3d(0.1, -0.05, 0.2));
  SequentialRandom random(82);
  std::vector<TimedReturn> returns;
  for (Time stamp{0}; stamp < 4900ms; stamp += 100ms) {
    for (int i = 0; i < 300; ++i) {
      const Time t = stamp + 300us * i;
      const Pose lidar = *truth.at(t) * body_from_lidar;
      const Vector3d direction =
          Vector3d(random.normal(), random.normal(), random.normal()).normalized();
      const world::Ray ray{lidar.translation(), direction.cast<float>()};
      world::Hit hit;
      world.cast(std::span(&ray, 1), 100.0, std::span(&hit, 1));
      const double range = double{hit.range} + 0.03 * random.normal();
      returns.push_back({t, lidar.inverse() * (ray.origin + range * direction)});
    }
  }
  const ObservedSurface seen = observe(returns, body_from_lidar, truth, world, kTwoThreads);
  EXPECT_EQ(seen.off_mesh, 0U);
  EXPECT_GT(seen.hits.size(), 10000U);
  for (const Vector3f& hit : seen.hits) {  // on a wall, although the returns have 3 cm of noise
    const Vector3d at = hit.cast<double>();
    const double off = (Vector3d(7, 8, 4) - at.cwiseAbs()).cwiseAbs().minCoeff();
    ASSERT_LT(off, 2e-5);
  }
  for (std::size_t t = 0; t < seen.free_side.size(); ++t) {
    EXPECT_EQ(seen.free_side[t], FreeSide::kBack) << t;  // outward normals, rays from inside
  }
}

TEST(ObservedSurface, TheReturnsOfAMapAreThoseThatItWasMadeOf) {
  const Trajectory estimate = flights::sample(flights::tour, 50ms, 5s);
  const Pose body_from_lidar = make_pose(so3::exp({0.3, -0.2, 1.1}), Vector3d(0.1, -0.05, 0.2));
  SequentialRandom random(83);
  dataset::Cloud map;
  std::vector<TimedReturn> expected;
  for (std::uint32_t i = 0; i < 100; ++i) {
    const Time t = 40ms * static_cast<int>(i) + Time{7};
    const Vector3d position(random.normal(), random.normal(), random.normal());
    map.points.push_back((*estimate.at(t) * body_from_lidar * position).cast<float>());
    map.origins.push_back({i, 0, to_seconds(t)});
    expected.push_back({t, position});
  }
  const std::vector<TimedReturn> returns = returns_of(map, BodyMotion(estimate), body_from_lidar);
  ASSERT_EQ(returns.size(), expected.size());
  for (std::size_t i = 0; i < returns.size(); ++i) {
    EXPECT_EQ(returns[i].stamp, expected[i].stamp);
    EXPECT_LT((returns[i].position - expected[i].position).norm(), 1e-5);
  }
}

TEST(SeenSamples, AreAsManyAsTheSeenAreaAndEquallyDenseOnLargeAndSmallTriangles) {
  // 2 m of floor as two triangles, and 2 m more as two thousand triangles
  world::TriangleMesh mesh;
  mesh.vertices = {{0, -1, 0}, {2, -1, 0}, {2, 1, 0}, {0, 1, 0}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  for (std::uint32_t i = 0; i < 1000; ++i) {
    const double x = 2.0 + 0.002 * i;
    const auto v = static_cast<std::uint32_t>(mesh.vertices.size());
    for (const double dx : {0.0, 0.002}) {
      mesh.vertices.emplace_back(x + dx, -1, 0);
      mesh.vertices.emplace_back(x + dx, 1, 0);
    }
    mesh.triangles.push_back({v, v + 2, v + 3});
    mesh.triangles.push_back({v, v + 3, v + 1});
  }
  const world::World world(mesh);
  Truths truths = hits_on_floor(4.0);
  const ObservedSurface seen = observe(truths, world, kTwoThreads);
  const SurfaceSamples samples = seen_samples(world, seen, kTwoThreads);
  EXPECT_NEAR(samples.area_m2(), 8.0, 0.02);  // 0.25 %
  const auto coarse = std::count_if(samples.offsets.begin(), samples.offsets.end(),
                                    [](const Vector3f& p) { return p.x() < 0.0F; });
  EXPECT_NEAR(static_cast<double>(coarse) / 4000.0, 1.0, 0.002);
  // each tile of 0.2 m^2 has about its 200 samples, because they are stratified (200 +- 14 if
  // random)
  std::vector<int> tiles(20, 0);
  for (const Vector3f& p : samples.offsets) {
    if (p.x() < 0.0F) ++tiles[static_cast<std::size_t>((p.x() + 2.0F) * 10.0F)];
  }
  for (const int tile : tiles) EXPECT_NEAR(tile, 200, 20);
  EXPECT_EQ(seen_samples(world, seen, Parallel(5)).offsets, samples.offsets);
}

TEST(SeenSamples, AreOfWhatWasSeenAndNotOfTheWholeMesh) {
  const world::World world(meshes::plane(10.0));
  Truths truths = hits_on_floor(3.0);
  const SurfaceSamples samples =
      seen_samples(world, observe(truths, world, kTwoThreads), kTwoThreads);
  // 3 x 2 m, and a margin of up to 2 cm around it
  EXPECT_GT(samples.area_m2(), 6.0 - 0.05);
  EXPECT_LT(samples.area_m2(), 3.04 * 2.04 + 0.05);
}

struct Scored {
  std::vector<Vector3f> map;
  const world::World& world;
  MortonOrder order = morton_order(map, kTwoThreads);
  Pose mesh_from_map = Pose::Identity();
  std::vector<PointScore> scores = score_points(map, order, mesh_from_map, world, kTwoThreads);
  Completeness rate(const SurfaceSamples& samples) const {
    return completeness(samples, completeness_grid(map, kTwoThreads), scores, mesh_from_map, world,
                        kTwoThreads);
  }
};

TEST(Completeness, OfHalfTheFloorIsAHalfAndAllOfItIsRight) {
  const world::World world(meshes::plane(10.0));
  Truths truths = hits_on_floor(4.0);
  const SurfaceSamples samples =
      seen_samples(world, observe(truths, world, kTwoThreads), kTwoThreads);
  std::vector<Vector3f> map;
  const Truths floor = hits_on_floor(2.0);
  for (const PointTruth& hit : floor.scans[0].points) map.push_back(hit.position);
  const Completeness c = Scored{map, world}.rate(samples);
  for (std::size_t row = 0; row < c.rows.size(); ++row) {
    // half, plus what lies within the distance beyond the border at x = 2 m
    const double expected = (2.0 + Completeness::kWithin_m[row] + 0.02) / 4.04;
    EXPECT_NEAR(c.rows[row].recall_percent, 100.0 * expected, 0.5);
    EXPECT_EQ(c.rows[row].precision_percent, 100.0);
    const double r = c.rows[row].recall_percent;
    EXPECT_NEAR(c.rows[row].f_score_percent, 2.0 * r * 100.0 / (r + 100.0), 1e-9);
  }
}

TEST(Completeness, FollowsTheLimits) {
  // A full map 7 cm above the floor: nothing within 5 cm, everything within 10.
  const world::World world(meshes::plane(10.0));
  Truths truths = hits_on_floor(2.0);
  const SurfaceSamples samples =
      seen_samples(world, observe(truths, world, kTwoThreads), kTwoThreads);
  std::vector<Vector3f> map;
  const Truths floor = hits_on_floor(2.0);
  for (const PointTruth& hit : floor.scans[0].points) {
    map.push_back(hit.position + Vector3f(0, 0, 0.07F));
  }
  const Completeness c = Scored{map, world}.rate(samples);
  for (std::size_t row = 0; row < c.rows.size(); ++row) {
    const double expected = row < 2 ? 0.0 : 100.0;
    EXPECT_EQ(c.rows[row].recall_percent, expected);
    EXPECT_EQ(c.rows[row].precision_percent, expected);
    EXPECT_EQ(c.rows[row].f_score_percent, expected);
  }
}

TEST(Completeness, OfAMapInItsOwnFrameGoesThroughTheAlignment) {
  const world::World world(meshes::plane(10.0));
  Truths truths = hits_on_floor(2.0);
  const SurfaceSamples samples =
      seen_samples(world, observe(truths, world, kTwoThreads), kTwoThreads);
  SequentialRandom random(83);
  const Pose mesh_from_map = flights::random_pose(random, 3.0);
  std::vector<Vector3f> map;
  const Truths floor = hits_on_floor(2.0);
  for (const PointTruth& hit : floor.scans[0].points) {
    map.push_back((mesh_from_map.inverse() * hit.position.cast<double>()).cast<float>());
  }
  const Scored scored{map, world, morton_order(map, kTwoThreads), mesh_from_map};
  EXPECT_EQ(scored.rate(samples).rows[0].recall_percent, 100.0);
}

TEST(Completeness, WithoutAMapOrWithoutSamplesIsZeroNotNaN) {
  const world::World world(meshes::plane(10.0));
  Truths truths = hits_on_floor(1.0);
  const SurfaceSamples samples =
      seen_samples(world, observe(truths, world, kTwoThreads), kTwoThreads);
  EXPECT_EQ((Scored{{}, world}.rate(samples).rows[3].recall_percent), 0.0);
  EXPECT_EQ((Scored{{{0, 0, 0}}, world}.rate({}).rows[3].recall_percent), 0.0);
}

}  // namespace
}  // namespace lidarena::evaluation
