// SPDX-License-Identifier: BSD-3-Clause
// Compares scans with the scanned surfaces: round walls in closed form, whole worlds by the nearest
// surface.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numbers>

#include "lidarena/base/trajectory.hpp"
#include "lidarena/flight/flight_config.hpp"
#include "lidarena/flight/spline_flight.hpp"
#include "lidarena/scenes/cave.hpp"
#include "lidarena/scenes/house.hpp"
#include "lidarena/scenes/load_world.hpp"
#include "tests/sensor/flights.hpp"
#include "tests/sensor/shipped.hpp"
#include "tests/sensor/worlds.hpp"

namespace lidarena::sensor {
namespace {

using Eigen::Vector3d;
using namespace testing;

constexpr double kTolerance = 1e-4;  // m: single precision leaves 1e-5 m at 40 m

/// A vertical cylinder of `facets` around the z axis, 200 m high.
world::TriangleMesh cylinder_mesh(double radius, int facets) {
  world::TriangleMesh mesh;
  for (int i = 0; i < facets; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / facets;
    for (const double z : {-100.0, 100.0}) {
      mesh.vertices.emplace_back(radius * std::cos(angle), radius * std::sin(angle), z);
    }
  }
  const auto n = static_cast<std::uint32_t>(facets);
  for (std::uint32_t i = 0; i < n; ++i) {
    const std::uint32_t next = (i + 1) % n;
    mesh.triangles.push_back({2 * i, 2 * i + 1, 2 * next + 1});
    mesh.triangles.push_back({2 * i, 2 * next + 1, 2 * next});
  }
  return mesh;
}

/// The points of a scan in world coordinates, each transformed by the pose at its own instant.
std::vector<Vector3d> in_world(const Scan& scan, const flight::Flight& flight, const Pose& mount) {
  std::vector<Vector3d> points;
  points.reserve(scan.points.size());
  for (const Point& point : scan.points) {
    points.push_back(flight.pose_at(time_of(scan, point)) * mount * point.position.cast<double>());
  }
  return points;
}

TEST(Geometry, AFinelyFacetedCylinderIsRoundToATenthOfAMillimeter) {
  const double radius = 40.0;
  // Facets lie within R (1 - cos(pi / n)) of the circle: 3e-5 m.
  const world::World world(cylinder_mesh(radius, 2560));
  const auto flight = rest(tilted_pose({5, -3, 2}, 0.4, -0.3, 1.0));
  for (const SensorConfig& base : {mid360(), ouster()}) {
    SensorConfig config = base;
    config.max_range_m = 120.0;
    const Lidar lidar = make_lidar(config);
    const Scan scan = lidar.measure(world, flight, 2, kOneThread);
    // Steep shots hit the wall beyond the maximum range.
    EXPECT_GT(scan.points.size(), lidar.pattern().beams_per_scan() * 8 / 10);
    double worst = 0.0;
    for (const Vector3d& p : in_world(scan, flight, config.body_from_lidar)) {
      worst = std::max(worst, std::abs(std::hypot(p.x(), p.y()) - radius));
    }
    EXPECT_LT(worst, kTolerance) << config.name;
  }
}

TEST(Geometry, AFinelyFacetedSphereIsRoundToItsFacets) {
  const double radius = 20.0;
  const world::TriangleMesh mesh =
      sphere_mesh(radius, 7);  // 131,072 facets with edges of about 0.3 m
  double deepest = radius;
  for (const world::Triangle& t : mesh.triangles) {
    const Vector3d middle = (mesh.vertices[t[0]] + mesh.vertices[t[1]] + mesh.vertices[t[2]]) / 3;
    deepest = std::min(deepest, middle.norm());
  }
  const world::World world(mesh);
  const auto flight = rest(tilted_pose({3, -4, 2}, -0.6, 0.5, 0.3));
  const Lidar lidar = make_lidar(mid360());
  const Scan scan = lidar.measure(world, flight, 2, kOneThread);
  EXPECT_EQ(scan.points.size(), 20'000U);
  for (const Vector3d& p : in_world(scan, flight, mid360().body_from_lidar)) {
    ASSERT_LT(p.norm(), radius + kTolerance);
    ASSERT_GT(p.norm(),
              deepest - kTolerance - 1e-4);  // the center of a facet is not its deepest point
  }
}

// Figure 3 of Vultaggio et al. 2023: round and flat walls as the official plugin reports them.
// Every range is too short by the minimum range m, so along its beam each point is m too near.
TEST(Geometry, TheOfficialFaultNarrowsACylinderByTheCosineOfElevation) {
  const double radius = 2.0, m = 0.1;
  const world::World world(cylinder_mesh(radius, 1440));
  SensorConfig config = mid360();
  config.body_from_lidar.setIdentity();
  config.min_range_m = m;
  config.max_range_m = 40.0;
  const auto flight = rest(Pose::Identity());
  const Scan right = make_lidar(config).measure(world, flight, 0, kOneThread);
  config.mode = ScanMode::kOfficial;
  const Scan wrong = make_lidar(config).measure(world, flight, 0, kOneThread);
  ASSERT_GT(right.points.size(), 19'000U);
  for (const Point& point : right.points) {
    ASSERT_NEAR(point.position.head<2>().norm(), radius, kTolerance);
  }
  double narrowest = radius, widest = 0.0;
  for (const Point& point : wrong.points) {
    const Vector3d p = point.position.cast<double>();
    const double cos_elevation = p.head<2>().norm() / p.norm();
    ASSERT_NEAR(p.head<2>().norm(), radius - m * cos_elevation, kTolerance);
    narrowest = std::min(narrowest, p.head<2>().norm());
    widest = std::max(widest, p.head<2>().norm());
  }
  EXPECT_NEAR(narrowest, 1.900, 1e-3);  // at the horizon
  EXPECT_NEAR(widest, 2.0 - 0.1 * std::cos(radians(52.0)), 2e-3);
}

TEST(Geometry, TheOfficialFaultBowsAFlatWallTowardsTheSensor) {
  const double distance = 5.0, m = 0.1;
  const world::World world(wall_mesh(distance));
  SensorConfig config = mid360();
  config.body_from_lidar.setIdentity();
  config.min_range_m = m;
  config.mode = ScanMode::kOfficial;
  const Scan scan = make_lidar(config).measure(world, rest(Pose::Identity()), 0, kOneThread);
  ASSERT_GT(scan.points.size(), 5000U);
  for (const Point& point : scan.points) {
    const Vector3d p = point.position.cast<double>();
    ASSERT_NEAR(p.x(), distance - m * p.x() / p.norm(), kTolerance);
  }
}

/// Largest accelerations of a flight's velocity and body rate, sampled every 5 ms.
struct Agility {
  double acceleration = 0.0;          ///< m/s^2
  double angular_acceleration = 0.0;  ///< rad/s^2
};

Agility agility_of(const flight::Flight& flight, Time end) {
  Agility agility;
  for (Time t{0}; t < end; t += std::chrono::milliseconds(5)) {
    const flight::Motion motion = flight.at(t);
    agility.acceleration = std::max(agility.acceleration, motion.acceleration_world.norm());
    agility.angular_acceleration =
        std::max(agility.angular_acceleration, motion.angular_acceleration_body.norm());
  }
  return agility;
}

Trajectory sampled(const flight::Flight& flight, Time end) {
  std::vector<StampedPose> poses;
  for (Time t{0}; t <= end; t += std::chrono::milliseconds(1)) {
    poses.push_back({t, flight.pose_at(t)});
  }
  return Trajectory(std::move(poses));
}

/// Simulates scans in a world and compares every `kStride`th point with the nearest surface,
/// transformed once with the pose of the flight and once with the truth sampled at 1 kHz and
/// interpolated. The interpolation error is at most h^2 / 8 times (acceleration + angular
/// acceleration * range).
void expect_on_surface(const world::World& world, const flight::Flight& flight,
                       const std::string& name) {
  constexpr std::size_t kStride = 7;
  const Time last = std::min<Time>(flight.duration(), std::chrono::seconds(8));
  const Trajectory truth = sampled(flight, last);
  const Agility agility = agility_of(flight, last);
  for (const SensorConfig& config : {mid360(), ouster()}) {
    const Lidar lidar = make_lidar(config);
    double worst = 0.0, worst_truth = 0.0, longest = 0.0, worst_frozen = 0.0;
    std::size_t count = 0;
    for (const std::uint64_t index : {12U, 31U, 55U, 72U}) {
      if (lidar.last_firing(index) >= last) continue;
      const Scan scan = lidar.measure(world, flight, index, Parallel(2));
      const Pose at_stamp = flight.pose_at(scan.stamp) * config.body_from_lidar;
      for (std::size_t i = 0; i < scan.points.size(); i += kStride) {
        const Vector3d p = config.body_from_lidar * scan.points[i].position.cast<double>();
        const Time t = time_of(scan, scan.points[i]);
        const auto off = [&](const Pose& pose) { return world.closest_point(pose * p).distance; };
        worst = std::max(worst, off(flight.pose_at(t)));
        worst_truth = std::max(worst_truth, off(*truth.at(t)));
        worst_frozen = std::max(
            worst_frozen,
            world.closest_point(at_stamp * scan.points[i].position.cast<double>()).distance);
        longest = std::max(longest, p.norm());
        ++count;
      }
    }
    ASSERT_GT(count, 5000U) << name;
    EXPECT_LT(worst, kTolerance) << name << " " << config.name;
    constexpr double kStep = 1e-3;
    const double interpolation =
        kStep * kStep / 8.0 * (agility.acceleration + agility.angular_acceleration * longest);
    EXPECT_LT(worst_truth, kTolerance + interpolation) << name << " " << config.name;
    EXPECT_GT(worst_frozen, 0.02) << name;  // the motion during a scan is relevant
    ::testing::Test::RecordProperty(name + "_" + config.name + "_flight_m", std::to_string(worst));
    ::testing::Test::RecordProperty(name + "_" + config.name + "_truth_1khz_m",
                                    std::to_string(worst_truth));
    ::testing::Test::RecordProperty(name + "_" + config.name + "_truth_bound_m",
                                    std::to_string(kTolerance + interpolation));
  }
}

flight::SplineFlight tour_of(const std::vector<Vector3d>& route, flight::FlightStyle style) {
  flight::FlightConfig config;
  config.style = style;
  return flight::SplineFlight(route, config, "test");
}

TEST(Geometry, EveryDeskewedPointOfAHouseLiesOnItsSurface) {
  world::WorldModel house = scenes::make_house(scenes::HouseConfig{}, 3);
  const flight::SplineFlight flight =
      tour_of(house.routes.front(), flight::FlightStyle::kAggressive);
  expect_on_surface(world::World(std::move(house.mesh)), flight, "house");
}

TEST(Geometry, EveryDeskewedPointOfACaveLiesOnItsSurface) {
  scenes::CaveConfig config;
  config.loops = 1;
  config.cell_length_m = config.cell_width_m = 12;
  world::WorldModel cave = scenes::make_cave(config, 3);
  const flight::SplineFlight flight = tour_of(cave.routes.front(), flight::FlightStyle::kBrisk);
  expect_on_surface(world::World(std::move(cave.mesh)), flight, "cave");
}

TEST(Geometry, EveryDeskewedPointOfTheLavaTubeLiesOnItsSurface) {
  const auto file =
      std::filesystem::path(LIDARENA_SHARED_DATA) / "meshes/lava_tube/worlds/lava_tube.world";
  if (!std::filesystem::exists(file)) {
    GTEST_SKIP() << "the shared test data is missing: the lava tube is not scanned";
  }
  scenes::WorldOptions options;
  options.allow_missing = true;
  LogSink log;
  const world::World world(scenes::load_world(file, options, log).mesh);
  // Up and down over the center of the tube's bounding box, where rays hit rock in any case.
  const Vector3d middle = world.closest_point(world.mesh().bounds().center()).point;
  const std::vector<Vector3d> tour{middle + Vector3d(-3, -3, 1), middle + Vector3d(3, -3, 2),
                                   middle + Vector3d(3, 3, 1), middle + Vector3d(-3, 3, 2),
                                   middle + Vector3d(-3, -3, 1)};
  expect_on_surface(world, tour_of(tour, flight::FlightStyle::kAggressive), "lava_tube");
}

}  // namespace
}  // namespace lidarena::sensor
