// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/sensor/lidar.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "tests/sensor/flights.hpp"
#include "tests/sensor/shipped.hpp"
#include "tests/sensor/worlds.hpp"

namespace lidarena::sensor {
namespace {

using Eigen::Vector3d;
using namespace testing;
using namespace world::testing;

// Single precision leaves 1e-5 m at 40 m; the pattern, the poses and the geometry are double.
constexpr double kPlaceTolerance = 1e-4;

/// The shots that returned the points of `scan`, for sensors whose shots are identified by (dt,
/// ring).
std::vector<Beam> shots_of(const Lidar& lidar, const Scan& scan, std::uint64_t index) {
  std::vector<Beam> beams;
  lidar.pattern().beams(index, beams);
  std::vector<Beam> shots;
  std::size_t i = 0;
  for (const Point& point : scan.points) {
    while (i < beams.size() && (beams[i].dt_ns != point.dt_ns || beams[i].ring != point.ring)) ++i;
    if (i == beams.size()) break;
    shots.push_back(beams[i]);
  }
  return shots;
}

/// Range of a point from the origin of its beam.
double range_of(const Point& point, const Beam& beam) {
  return static_cast<double>((point.position - beam.origin).norm());
}

/// Largest difference between the ranges of a scan and expected(origin, direction), both in the
/// world frame, with the lidar at its pose of each instant.
template <class Expected>
double worst_range_error(const Lidar& lidar, const Scan& scan, const flight::Flight& flight,
                         const Pose& body_from_lidar, std::uint64_t index, Expected&& expected) {
  const auto shots = shots_of(lidar, scan, index);
  EXPECT_EQ(shots.size(), scan.points.size());
  double worst = 0.0;
  for (std::size_t i = 0; i < shots.size(); ++i) {
    const Pose pose = flight.pose_at(time_of(scan, scan.points[i])) * body_from_lidar;
    const Vector3d origin = pose * shots[i].origin.cast<double>();
    const Vector3d direction = pose.linear() * shots[i].direction.cast<double>();
    worst =
        std::max(worst, std::abs(range_of(scan.points[i], shots[i]) - expected(origin, direction)));
  }
  return worst;
}

TEST(Lidar, ATiltedSensorMeasuresAWallWherePlaneGeometryPutsIt) {
  const world::World world(wall_mesh(30.0));
  const auto flight = rest(tilted_pose({2, 1, -3}, 0.4, -0.3, 0.2));
  for (const SensorConfig& config : {mid360(), ouster()}) {
    const Lidar lidar = make_lidar(config);
    const Scan scan = lidar.measure(world, flight, 4, kOneThread);
    EXPECT_GT(scan.points.size(), 1000U);
    const double worst = worst_range_error(
        lidar, scan, flight, config.body_from_lidar, 4,
        [](const Vector3d& o, const Vector3d& d) { return (30.0 - o.x()) / d.x(); });
    EXPECT_LT(worst, kPlaceTolerance) << config.name;
  }
}

TEST(Lidar, InABoxEveryShotReturnsAndEveryRangeIsRight) {
  const Vector3d low(-40, -15, -4);
  const Vector3d high(38, 12, 5);
  const world::World world(box_mesh(low, high));
  const auto flight = rest(tilted_pose({-2, 3, 1}, -0.5, 0.6, 2.0));
  for (const SensorConfig& config : {mid360(), ouster()}) {
    const Lidar lidar = make_lidar(config);
    const Scan scan = lidar.measure(world, flight, 11, kOneThread);
    EXPECT_EQ(scan.points.size(), lidar.pattern().beams_per_scan());
    const double worst = worst_range_error(
        lidar, scan, flight, config.body_from_lidar, 11,
        [&](const Vector3d& o, const Vector3d& d) { return range_in_box(low, high, o, d); });
    EXPECT_LT(worst, kPlaceTolerance) << config.name;
  }
}

TEST(Lidar, AWorldFarFromTheOriginLosesNothing) {
  const Vector3d far(500'000, -300'000, 800);
  const Vector3d low = far + Vector3d(-20, -15, -4);
  const Vector3d high = far + Vector3d(18, 12, 5);
  const world::World world(box_mesh(low, high));
  const auto flight = rest(tilted_pose(far + Vector3d(-2, 3, 1), -0.5, 0.6, 2.0));
  const Lidar lidar = make_lidar(mid360());
  const Scan scan = lidar.measure(world, flight, 0, kOneThread);
  const double worst = worst_range_error(
      lidar, scan, flight, mid360().body_from_lidar, 0,
      [&](const Vector3d& o, const Vector3d& d) { return range_in_box(low, high, o, d); });
  EXPECT_EQ(scan.points.size(), 20'000U);
  EXPECT_LT(worst, kPlaceTolerance);
}

TEST(Lidar, ASphereOfFacetsIsMeasuredAsItsFacets) {
  const world::TriangleMesh mesh = sphere_mesh(35.0, 3);
  const world::World world(mesh);
  const auto flight = rest(tilted_pose({3, -4, 2}, 0.3, 0.2, -1.0));
  SensorConfig config = mid360();
  config.rate_hz = 100.0;  // 2000 rows
  const Lidar lidar = make_lidar(config);
  const Scan scan = lidar.measure(world, flight, 3, kOneThread);
  EXPECT_EQ(scan.points.size(), 2000U);
  const double worst = worst_range_error(
      lidar, scan, flight, config.body_from_lidar, 3,
      [&](const Vector3d& o, const Vector3d& d) { return brute_force_cast(mesh, o, d); });
  EXPECT_LT(worst, kPlaceTolerance);
}

struct Offsets {
  double worst_at_own_instant = 0.0;  ///< m from the box, each point transformed by its own pose
  double worst_at_stamp = 0.0;  ///< m from the box, all points transformed by the pose at the stamp
};

/// Scan 5 of a sensor on a swinging flight in a box, transformed to the world in two ways.
Offsets offsets_in_box(const SensorConfig& config) {
  const Vector3d low(-12, -10, -6);
  const Vector3d high(11, 9, 7);
  const world::World world(box_mesh(low, high));
  const SwingingFlight flight(10.0);
  const Lidar lidar = make_lidar(config);
  const Scan scan = lidar.measure(world, flight, 5, kOneThread);
  EXPECT_EQ(scan.points.size(), lidar.pattern().beams_per_scan());
  Offsets offsets;
  const Pose at_stamp = flight.pose_at(scan.stamp) * config.body_from_lidar;
  for (const Point& point : scan.points) {
    const Vector3d position = point.position.cast<double>();
    const Pose at_instant = flight.pose_at(time_of(scan, point)) * config.body_from_lidar;
    offsets.worst_at_own_instant =
        std::max(offsets.worst_at_own_instant, distance_to_box(low, high, at_instant * position));
    offsets.worst_at_stamp =
        std::max(offsets.worst_at_stamp, distance_to_box(low, high, at_stamp * position));
  }
  return offsets;
}

TEST(Lidar, ARollingScanInMotionLiesOnTheMeshOnlyWithThePoseOfEachInstant) {
  for (const SensorConfig& config : {mid360(), ouster()}) {
    const Offsets offsets = offsets_in_box(config);
    EXPECT_LT(offsets.worst_at_own_instant, kPlaceTolerance) << config.name;
    EXPECT_GT(offsets.worst_at_stamp, 0.1) << config.name;  // it moves by about 2 m/s and 1 rad/s
  }
}

TEST(Lidar, AFrozenScanLiesOnTheMeshOnlyWithThePoseAtTheStamp) {
  SensorConfig config = mid360();
  config.mode = ScanMode::kFrozen;
  const Offsets frozen = offsets_in_box(config);
  EXPECT_LT(frozen.worst_at_stamp, kPlaceTolerance);
  EXPECT_GT(frozen.worst_at_own_instant, 0.1);

  config.mode = ScanMode::kFrozenUnstamped;
  const Offsets unstamped = offsets_in_box(config);
  EXPECT_LT(unstamped.worst_at_stamp, kPlaceTolerance);
  EXPECT_LT(unstamped.worst_at_own_instant, kPlaceTolerance);
}

TEST(Lidar, OnlyRollingAndFrozenScansCarryTimes) {
  const world::World world(box_mesh({-5, -5, -5}, {5, 5, 5}));
  const SwingingFlight flight(1.0);
  for (const ScanMode mode :
       {ScanMode::kRolling, ScanMode::kFrozen, ScanMode::kFrozenUnstamped, ScanMode::kOfficial}) {
    SensorConfig config = mid360();
    config.mode = mode;
    const Scan scan = make_lidar(config).measure(world, flight, 2, kOneThread);
    const bool timed = mode == ScanMode::kRolling || mode == ScanMode::kFrozen;
    EXPECT_EQ(scan.timed, timed);
    EXPECT_EQ(scan.stamp, std::chrono::milliseconds(200));
    EXPECT_EQ(scan.points.back().dt_ns, timed ? 19'999 * 5000 : 0);
  }
}

TEST(Lidar, ARampOfTimesRisesEvenlyOverThePointsAndItsLengthIsAnotherInEachScan) {
  const world::World world(box_mesh({-5, -5, -5}, {5, 5, 5}));
  const SwingingFlight flight(10.0);
  SensorConfig config = mid360();
  config.mode = ScanMode::kFrozenRamp;
  config.ramp_s = 0.08;
  const Lidar lidar = make_lidar(config);
  config.mode = ScanMode::kFrozenUnstamped;
  const Lidar unstamped = make_lidar(config);
  double shortest = 1.0, longest = 0.0, sum = 0.0;
  constexpr int kScans = 40;
  for (std::uint64_t k = 0; k < kScans; ++k) {
    const Scan scan = lidar.measure(world, flight, k, kOneThread);
    EXPECT_TRUE(scan.timed);
    const double step_ns = scan.points.back().dt_ns / 19'999.0;
    for (std::size_t i = 0; i < scan.points.size(); i += 777)
      EXPECT_NEAR(scan.points[i].dt_ns, step_ns * static_cast<double>(i), 2.0);
    const double length = 1e-9 * step_ns * 20'000.0;
    EXPECT_GE(lidar.last_firing(k), scan.stamp + Time{scan.points.back().dt_ns});
    shortest = std::min(shortest, length);
    longest = std::max(longest, length);
    sum += length;
    const Scan same = unstamped.measure(world, flight, k, kOneThread);
    ASSERT_EQ(same.points.size(), scan.points.size());
    EXPECT_EQ(same.points.back().position, scan.points.back().position);
    EXPECT_EQ(lidar.measure(world, flight, k, kOneThread).points.back().dt_ns,
              scan.points.back().dt_ns);
  }
  EXPECT_GT(shortest, 0.04 - 1e-6);
  EXPECT_LT(shortest, 0.05);
  EXPECT_GT(longest, 0.11);
  EXPECT_LT(longest, 0.12 + 1e-6);
  EXPECT_NEAR(sum / kScans, 0.08, 4.0 * 0.08 / std::sqrt(12.0 * kScans));  // four sigma
}

TEST(Lidar, AShotWithoutReturnIsAPointAtTheOriginIfAskedFor) {
  const world::World world(wall_mesh(30.0));  // before the sensor; nothing behind it
  const auto flight = rest(Pose::Identity());
  SensorConfig config = mid360();
  config.body_from_lidar.setIdentity();
  const Scan returns = make_lidar(config).measure(world, flight, 3, kOneThread);
  config.returns.misses = MissedShots::kOrigin;
  for (const int bounces : {0, 1}) {  // by the short way from hits to points, and by the long one
    config.noise.bounces = bounces;
    std::vector<PointTruth> truth;
    const Scan all = make_lidar(config).measure(world, flight, 3, kOneThread, &truth);
    ASSERT_EQ(all.points.size(), 20'000U);
    ASSERT_EQ(truth.size(), all.points.size());
    std::vector<Point> far;
    for (std::size_t i = 0; i < all.points.size(); ++i) {
      const Point& point = all.points[i];
      const bool is_miss = point.position.norm() < 1e-5F;
      EXPECT_FALSE(point.position.isZero(0.0F)) << "readers would drop it";
      EXPECT_EQ(point.dt_ns, static_cast<std::int32_t>(5000 * i));
      EXPECT_EQ(is_miss, truth[i].triangle == kGhost);
      if (!is_miss) far.push_back(point);
    }
    ASSERT_EQ(far.size(), returns.points.size());
    for (std::size_t i = 0; i < far.size(); ++i)
      EXPECT_EQ(far[i].position, returns.points[i].position);
  }
}

TEST(Lidar, ASteadyYawSpinSweepsAWallInClosedForm) {
  const double distance = 8.0;
  const double rate = 2.5;
  const world::World world(wall_mesh(distance));
  const UniformFlight flight(Pose::Identity(), Vector3d::Zero(), {0, 0, rate}, 5.0);
  SensorConfig config = mid360();
  config.body_from_lidar.setIdentity();
  const Lidar lidar = make_lidar(config);
  const Scan scan = lidar.measure(world, flight, 6, kOneThread);
  const auto shots = shots_of(lidar, scan, 6);
  ASSERT_GT(shots.size(), 5000U);
  for (std::size_t i = 0; i < shots.size(); ++i) {
    const double yaw = rate * (0.6 + 1e-9 * shots[i].dt_ns);
    const Vector3d u = shots[i].direction.cast<double>();
    const double towards_wall = std::cos(yaw) * u.x() - std::sin(yaw) * u.y();
    EXPECT_NEAR(
        range_of(scan.points[i], shots[i]), distance / towards_wall,
        kPlaceTolerance * std::max(1.0, 0.1 / towards_wall));  // error grows at grazing incidence
  }
}

TEST(Lidar, RangeLimitsFilterTheTrueRangeAndMoveNothing) {
  const double distance = 0.08;
  const world::World world(wall_mesh(distance));
  SensorConfig config = mid360();
  config.body_from_lidar.setIdentity();
  config.min_range_m = 0.1;
  config.max_range_m = 0.5;
  const Lidar lidar = make_lidar(config);
  const auto flight = rest(Pose::Identity());
  std::vector<Beam> beams;
  lidar.pattern().beams(0, beams);
  std::size_t expected = 0;
  for (const Beam& beam : beams) {
    const double range = distance / static_cast<double>(beam.direction.x());
    if (range >= 0.1 && range <= 0.5) ++expected;
  }
  const Scan scan = lidar.measure(world, flight, 0, kOneThread);
  EXPECT_GT(expected, 1000U);
  EXPECT_NEAR(static_cast<double>(scan.points.size()), static_cast<double>(expected), 1.0);
  for (const Point& point : scan.points) EXPECT_NEAR(point.position.x(), distance, 1e-6);
}

TEST(Lidar, SomethingTooNearHidesWhatIsBehindIt) {
  world::TriangleMesh mesh = wall_mesh(0.05);
  mesh.append(wall_mesh(20.0));
  const world::World world(std::move(mesh));
  SensorConfig config = mid360();
  config.body_from_lidar.setIdentity();
  const auto flight = rest(Pose::Identity());
  for (const Point& point : make_lidar(config).measure(world, flight, 0, kOneThread).points) {
    EXPECT_LT(point.position.x(), 0.051F);
  }
  // With the fault of the official plugin, shots start at the minimum range, behind the near wall.
  config.mode = ScanMode::kOfficial;
  std::size_t seen_through = 0;
  for (const Point& point : make_lidar(config).measure(world, flight, 0, kOneThread).points) {
    if (point.position.x() > 15.0F) ++seen_through;
  }
  EXPECT_GT(seen_through, 1000U);
}

TEST(Lidar, TheOfficialFaultShortensEveryRangeByTheMinimumRange) {
  const world::World world(box_mesh({-9, -8, -3}, {7, 6, 5}));
  const auto flight = rest(Pose::Identity());
  SensorConfig config = mid360();
  const Scan right = make_lidar(config).measure(world, flight, 0, kOneThread);
  config.mode = ScanMode::kOfficial;
  const Scan wrong = make_lidar(config).measure(world, flight, 0, kOneThread);
  ASSERT_EQ(right.points.size(), wrong.points.size());
  for (std::size_t i = 0; i < right.points.size(); ++i) {
    EXPECT_NEAR(right.points[i].position.norm() - wrong.points[i].position.norm(), 0.1,
                kPlaceTolerance);
  }
}

TEST(Lidar, TheTruthIsWhereTheDeskewedPointsLieWithoutNoise) {
  const world::World world(box_mesh({-12, -10, -6}, {11, 9, 7}));
  const SwingingFlight flight(10.0);
  for (const SensorConfig& config : {mid360(), ouster()}) {
    const Lidar lidar = make_lidar(config);
    std::vector<PointTruth> truth;
    const Scan scan = lidar.measure(world, flight, 5, Parallel(2), &truth);
    ASSERT_EQ(truth.size(), scan.points.size());
    const auto shots = shots_of(lidar, scan, 5);
    double worst = 0.0;
    for (std::size_t i = 0; i < truth.size(); ++i) {
      const Pose pose = flight.pose_at(time_of(scan, scan.points[i])) * config.body_from_lidar;
      const Vector3d position = truth[i].position.cast<double>();
      worst = std::max(worst, (pose * scan.points[i].position.cast<double>() - position).norm());
      const world::Triangle& corners = world.mesh().triangles[truth[i].triangle];
      const Vector3d normal = world.mesh().cross(truth[i].triangle).normalized();
      ASSERT_NEAR(normal.dot(position - world.mesh().vertices[corners[0]]), 0.0, kPlaceTolerance);
      ASSERT_NEAR(std::abs(normal.dot(truth[i].normal.cast<double>())), 1.0, 1e-6);
      ASSERT_GT(truth[i].normal.cast<double>().dot(pose.translation() - position), 0.0);
      ASSERT_NEAR(truth[i].range,
                  shots[i].origin.norm() + (scan.points[i].position - shots[i].origin).norm(),
                  kPlaceTolerance);
    }
    EXPECT_LT(worst, kPlaceTolerance) << config.name;
  }
}

TEST(Lidar, NoiseMovesThePointsAndNotTheirTruth) {
  const world::World world(box_mesh({-12, -10, -6}, {11, 9, 7}));
  const SwingingFlight flight(10.0);
  SensorConfig config = mid360();
  std::vector<PointTruth> exact, noisy;
  const Scan right = make_lidar(config).measure(world, flight, 2, kOneThread, &exact);
  config.range_noise_m = 0.05;
  const Scan moved = make_lidar(config).measure(world, flight, 2, kOneThread, &noisy);
  ASSERT_EQ(exact.size(), noisy.size());
  for (std::size_t i = 0; i < exact.size(); ++i) {
    EXPECT_EQ(exact[i].position, noisy[i].position);
    EXPECT_EQ(exact[i].range, noisy[i].range);
    EXPECT_EQ(exact[i].triangle, noisy[i].triangle);
  }
  EXPECT_FALSE(same(right, moved));
}

TEST(Lidar, RangeNoiseIsGaussianWithTheConfiguredSigmaAlongTheBeam) {
  const world::World world(box_mesh({-9, -8, -3}, {7, 6, 5}));
  const auto flight = rest(tilted_pose({1, 1, 1}, 0.1, 0.2, 0.3));
  SensorConfig config = mid360();
  config.range_noise_m = 0.02;
  const Lidar lidar = make_lidar(config);
  double sum = 0.0, squares = 0.0;
  std::size_t count = 0, beyond_two_sigma = 0;
  for (std::uint64_t index = 0; index < 3; ++index) {
    std::vector<PointTruth> truth;
    const Scan scan = lidar.measure(world, flight, index, kOneThread, &truth);
    const auto shots = shots_of(lidar, scan, index);
    ASSERT_EQ(truth.size(), scan.points.size());
    for (std::size_t i = 0; i < shots.size(); ++i) {
      const Eigen::Vector3f& position = scan.points[i].position;
      EXPECT_LT(position.cross(shots[i].direction).norm(), 1e-5F);
      const double error = range_of(scan.points[i], shots[i]) - static_cast<double>(truth[i].range);
      sum += error;
      squares += error * error;
      if (std::abs(error) > 0.04) ++beyond_two_sigma;
      ++count;
    }
  }
  const auto n = static_cast<double>(count);
  EXPECT_EQ(count, 60'000U);
  EXPECT_NEAR(sum / n, 0.0, 4 * 0.02 / std::sqrt(n));
  EXPECT_NEAR(std::sqrt(squares / n), 0.02, 4 * 0.02 / std::sqrt(2 * n));
  const double p = std::erfc(2.0 / std::sqrt(2.0));  // share of a Gaussian beyond two sigma
  EXPECT_NEAR(static_cast<double>(beyond_two_sigma) / n, p, 4 * std::sqrt(p * (1 - p) / n));
}

TEST(Lidar, ScansAreTheSameOnAnyNumberOfThreadsAndInAnyOrder) {
  const world::World world(box_mesh({-9, -8, -3}, {7, 6, 5}));
  const SwingingFlight flight(2.0);
  for (SensorConfig config : {mid360(), ouster()}) {
    config.range_noise_m = 0.02;
    const Lidar lidar = make_lidar(config);
    std::vector<Scan> scans;
    for (std::uint64_t i = 0; i < 4; ++i) {
      scans.push_back(lidar.measure(world, flight, i, kOneThread));
    }
    for (const int threads : {1, 2, 5}) {
      const Parallel parallel(threads);
      const Lidar twin = make_lidar(config);
      for (const std::uint64_t i : {3U, 0U, 2U, 1U}) {
        EXPECT_TRUE(same(twin.measure(world, flight, i, parallel), scans[i])) << threads;
      }
    }
    EXPECT_FALSE(same(make_lidar(config, 2).measure(world, flight, 0, kOneThread), scans[0]));
    const Lidar other_name(config, make_pattern(config), "other", 1, true);
    EXPECT_FALSE(same(other_name.measure(world, flight, 0, kOneThread), scans[0]));
  }
}

TEST(Lidar, IntensityIsTheReflectivityTimesTheCosineOfIncidence) {
  world::TriangleMesh wall = wall_mesh(10.0);
  wall.paint({"gray", 0.4, 0.0});
  const world::World world(std::move(wall));
  SensorConfig config = mid360();
  config.body_from_lidar.setIdentity();
  const Scan scan = make_lidar(config).measure(world, rest(Pose::Identity()), 0, kOneThread);
  ASSERT_GT(scan.points.size(), 1000U);
  for (const Point& point : scan.points) {
    EXPECT_NEAR(point.intensity, 0.4F * 255.0F * point.position.normalized().x(), 1e-3);
  }
}

}  // namespace
}  // namespace lidarena::sensor
