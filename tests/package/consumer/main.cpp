// SPDX-License-Identifier: BSD-3-Clause
// Casts a ray at a wall 1 m away, measures a map error, and constructs every algorithm.
#include <lidarena/base/parallel.hpp>
#include <lidarena/evaluation/map/map_error.hpp>
#include <lidarena/odometry/factory.hpp>
#include <lidarena/sensor/sensor_config.hpp>
#include <lidarena/world/primitives.hpp>
#include <lidarena/world/world.hpp>

#include <array>
#include <cmath>
#include <cstdio>

int main() {
  using namespace lidarena;
  const world::World world(world::box_shape({2.0, 2.0, 2.0}), "cube");
  const std::array rays{world::Ray{Eigen::Vector3d::Zero(), Eigen::Vector3f::UnitX()}};
  std::array<world::Hit, 1> hits;
  world.cast(rays, 10.0, hits);
  if (std::abs(hits[0].range - 1.0F) > 1e-5F) return 1;

  const std::array map{Eigen::Vector3f{1.5F, 0.0F, 0.0F}};
  const evaluation::MapError error =
      evaluation::map_error(map, Pose::Identity(), world, Parallel(1));
  if (std::abs(error.distance_m.mean - 0.5) > 1e-6) return 2;

  Rig rig;
  rig.lidars.emplace_back().id = "lidar";
  rig.imus.emplace_back().id = "lidar";
  for (const odometry::AlgorithmInfo& info : odometry::list_algorithms()) {
    if (!odometry::make_odometry({info.name}, rig, "lidar", Parallel(1)).odometry) return 3;
    std::printf("%s\n", info.name.c_str());
  }
}
