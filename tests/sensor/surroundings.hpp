// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <vector>

#include "lidarena/sensor/air.hpp"
#include "lidarena/sensor/simulate.hpp"
#include "tests/sensor/flights.hpp"
#include "tests/sensor/shipped.hpp"
#include "tests/sensor/worlds.hpp"

/// Sensors and worlds of the tests of panes, air and reflectors.
namespace lidarena::sensor::testing {

inline SensorConfig mid360_at_origin() {
  SensorConfig config = mid360();
  config.body_from_lidar.setIdentity();
  config.max_range_m = 200.0;
  return config;
}

struct Received {
  Scan scan;
  std::vector<PointTruth> truth;
};

inline Received received(const SensorConfig& config, const world::Surfaces& world,
                         std::uint64_t index = 0, std::uint64_t seed = 1) {
  Received received;
  received.scan =
      make_lidar(config, seed)
          .measure(world, rest(Pose::Identity(), 4000), index, kOneThread, &received.truth);
  return received;
}

/// A rectangle of one material, with two sides from a corner.
inline world::TriangleMesh sheet(const Eigen::Vector3d& corner, const Eigen::Vector3d& a,
                                 const Eigen::Vector3d& b, const world::Material& material) {
  world::TriangleMesh mesh;
  mesh.vertices = {corner, corner + a, corner + a + b, corner + b};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  mesh.paint(material);
  return mesh;
}

inline world::World world_of(const std::vector<world::TriangleMesh>& parts) {
  world::TriangleMesh all;
  for (const world::TriangleMesh& part : parts) all.append(part);
  return world::World(std::move(all), "parts", world::RayCaster::kBvh);
}

/// The plane x = `x`, 80 m wide and high.
inline world::TriangleMesh upright(double x, const world::Material& material) {
  return sheet({x, -40, -40}, {0, 80, 0}, {0, 0, 80}, material);
}

inline const world::Material kWhiteWall{"white wall", 0.8, 0.0};
inline const world::Material kPane{"pane", 0.08, 0.95, 0.9};

/// The energy of a return by its intensity.
inline double energy_of(const Point& point) { return static_cast<double>(point.intensity) / 255.0; }

inline double cosine_to_x(const Point& point) {
  return std::abs(static_cast<double>(point.position.normalized().x()));
}

/// A Mid-360 that is rated for 40 m and 70 m, with a beam of 0.2 deg.
inline SensorConfig in_air(const AirConfig& air) {
  SensorConfig config = mid360_at_origin();
  config.noise.signal = {.range_at_10_m = 40.0, .range_at_80_m = 70.0};
  config.noise.beam.width_deg = config.noise.beam.height_deg = 0.2;
  config.noise.air = air;
  config.returns.choice = EchoChoice::kFirst;
  return config;
}

inline AirConfig fog(double visibility_m) {
  AirConfig air;
  air.visibility_m = visibility_m;
  return air;
}

inline AirConfig rain(double mm_h) {
  AirConfig air;
  air.rain_mm_h = mm_h;
  return air;
}

}  // namespace lidarena::sensor::testing
