// SPDX-License-Identifier: BSD-3-Clause
// Cast rays into a world: distances around a point in the House. usage: example_01_cast_rays
#include <cmath>
#include <cstdio>
#include <numbers>
#include <vector>

#include "lidarena/scenes/load_world.hpp"
#include "lidarena/stages/config_folder.hpp"
#include "lidarena/world/world.hpp"

int main() {
  using namespace lidarena;
  LogSink silent;
  const stages::ConfigFolder configs = stages::ConfigFolder::find(".");
  const world::World world(scenes::load_world(configs.resolve("worlds", "house"), {}, silent).mesh,
                           "house");

  const Eigen::Vector3d center(2.0, 2.0, 1.2);  // m
  std::vector<world::Ray> rays;
  for (int degrees = 0; degrees < 360; degrees += 30) {
    const double angle = degrees * std::numbers::pi / 180.0;
    rays.push_back({center, Eigen::Vector3d(std::cos(angle), std::sin(angle), 0.0).cast<float>()});
  }
  std::vector<world::Hit> hits(rays.size());
  world.cast(rays, 50.0, hits);

  float min_range = 50.0F;
  for (std::size_t i = 0; i < hits.size(); ++i) {
    std::printf("%4zu deg: %6.2f m\n", 30 * i, static_cast<double>(hits[i].range));
    min_range = std::min(min_range, hits[i].range);
  }
  const world::ClosestPoint nearest = world.closest_point(center);
  std::printf("the nearest surface is %.3f m away, at %.3f %.3f %.3f\n", nearest.distance,
              nearest.point.x(), nearest.point.y(), nearest.point.z());
  return nearest.distance <= static_cast<double>(min_range) + 1e-4 ? 0 : 1;
}
