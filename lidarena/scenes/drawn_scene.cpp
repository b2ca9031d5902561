// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/scenes/drawn_scene.hpp"

#include <algorithm>

#include "lidarena/base/random.hpp"

namespace lidarena::scenes {

HouseConfig drawn_house(HouseConfig config, std::uint64_t seed) {
  SequentialRandom random(seed, stream_of("drawn house"));
  config.width_m = random.uniform(15.0, 20.0);
  config.depth_m = random.uniform(10.0, 14.0);
  config.story_height_m = random.uniform(2.5, 3.2);
  config.wall_thickness_m = random.uniform(0.1, 0.2);
  config.door_height_m = random.uniform(2.0, 2.2);
  config.variation_m = 0.3;
  config.high_rooms = random.uniform() < 0.6;
  config.furnishing = std::min(1.0, random.uniform(0.0, 1.5));  // all of it in a third of the cases
  config.symmetric = random.uniform() < 0.25;
  if (config.symmetric) {  // low and bare as well: rooms that only their doors tell apart
    config.story_height_m = random.uniform(2.5, 2.6);
    config.high_rooms = false;
    config.furnishing = std::max(0.0, random.uniform(-0.1, 0.1));
  }
  return config;
}

CaveConfig drawn_cave(CaveConfig config, std::uint64_t seed) {
  SequentialRandom random(seed, stream_of("drawn cave"));
  config.loops = random.integer(2, 6);
  config.cell_length_m = random.uniform(18.0, 34.0);
  config.cell_width_m = random.uniform(16.0, 30.0);
  config.winding_m = random.uniform(0.5, 2.5);
  config.relief_m = random.uniform(0.0, 3.0);
  config.roughness_2m_m = random.uniform(0.05, 0.45);
  config.roughness_03m_m = random.uniform(0.02, 0.12);
  config.roughness_005m_m = random.uniform(0.0, 0.03);
  config.width_min_m = random.uniform(2.0, 2.6);
  // Room for the roughness on both sides (see make_cave).
  const double roughness = config.roughness_2m_m + config.roughness_03m_m + config.roughness_005m_m;
  config.width_max_m = config.width_min_m + 2.4 * roughness + random.uniform(0.4, 1.8);
  return config;
}

MineConfig drawn_mine(MineConfig config, std::uint64_t seed) {
  SequentialRandom random(seed, stream_of("drawn mine"));
  config.columns = random.integer(3, 5);
  config.rows = random.integer(2, 4);
  config.spacing_m = random.uniform(18.0, 26.0);
  config.height_m = random.uniform(2.6, 3.6);
  config.relief_m = random.uniform(0.0, 1.5);
  config.branches = random.uniform(0.6, 1.0);
  config.supports = random.uniform(0.0, 1.0);
  config.roughness_1m_m = random.uniform(0.04, 0.2);
  config.roughness_03m_m = random.uniform(0.01, 0.08);
  return config;
}

ForestConfig drawn_forest(ForestConfig config, std::uint64_t seed) {
  SequentialRandom random(seed, stream_of("drawn forest"));
  config.size_m = random.uniform(50.0, 80.0);
  config.trees_per_ha = random.uniform(250.0, 1000.0);
  config.conifers = random.uniform();
  config.undergrowth = random.uniform(0.0, 2.0);
  config.relief_m = random.uniform(0.0, 4.0);
  config.roughness_2m_m = random.uniform(0.05, 0.35);
  config.roughness_04m_m = random.uniform(0.02, 0.1);
  return config;
}

HallConfig drawn_hall(HallConfig config, std::uint64_t seed) {
  SequentialRandom random(seed, stream_of("drawn hall"));
  config.rows = 2 * random.integer(1, 4) + 1;
  config.length_m = random.uniform(35.0, 80.0);
  config.aisle_m = random.uniform(2.6, 4.0);
  config.levels = random.integer(2, 4);
  config.height_m = 1.6 * config.levels + random.uniform(2.0, 5.0);
  config.filling = random.uniform(0.4, 1.0);
  return config;
}

OfficeConfig drawn_office(OfficeConfig config, std::uint64_t seed) {
  SequentialRandom random(seed, stream_of("drawn office"));
  config.offices = random.integer(6, 14);
  config.office_width_m = random.uniform(3.0, 4.5);
  config.office_depth_m = random.uniform(4.0, 6.0);
  config.corridor_m = random.uniform(2.0, 2.8);
  config.core_m = random.uniform(3.0, 8.0);
  config.height_m = random.uniform(2.6, 3.2);
  config.open_doors = random.uniform(0.0, 1.0);
  return config;
}

std::vector<Eigen::Vector3d> drawn_route(std::vector<Eigen::Vector3d> route, std::uint64_t seed) {
  SequentialRandom random(seed, stream_of("drawn route"));
  const double start = random.uniform();
  const bool backwards = random.uniform() < 0.5;
  if (route.size() > 2 && route.front() == route.back()) {
    route.pop_back();
    const auto first = static_cast<std::ptrdiff_t>(start * static_cast<double>(route.size()));
    std::ranges::rotate(route, route.begin() + first);
    route.push_back(route.front());
  }
  if (backwards) std::ranges::reverse(route);
  return route;
}

}  // namespace lidarena::scenes
