// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/scenes/forest.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "lidarena/base/random.hpp"
#include "lidarena/scenes/gradient_noise.hpp"
#include "lidarena/scenes/mesh_builder.hpp"
#include "lidarena/scenes/trees.hpp"

namespace lidarena::scenes {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using std::numbers::pi;

constexpr double kLoopStep = 2.0;        // m
constexpr double kLoopHeight = 1.8;      // m above the highest ground within kLoopStep
constexpr double kTrunkClearance = 1.2;  // m, from the route to a trunk's surface, on the ground
constexpr double kLowClearance = 0.6;    // m, from the route to low things, in plan
constexpr double kBetweenTrees = 1.4;    // m
constexpr double kEdge = 1.0;            // m, without trees along the ground's edge
const world::Material kBark{"bark", 0.35, 0.0};
const world::Material kSoil{"soil", 0.3, 0.0};

/// Height of the ground, m.
class Ground {
 public:
  Ground(const ForestConfig& config, std::uint64_t seed)
      : config_(config), hills_(3 * seed + 11), bumps_(3 * seed + 12), rough_(3 * seed + 13) {}
  double operator()(const Vector2d& p) const {
    const auto wave = [&](const GradientNoise& noise, double step) {
      return noise({p.x() / step, p.y() / step, 0.5});
    };
    return config_.relief_m * wave(hills_, 20.0) + config_.roughness_2m_m * wave(bumps_, 2.0) +
           config_.roughness_04m_m * wave(rough_, 0.4);
  }
  Vector3d at(const Vector2d& p, double above = 0.0) const {
    return {p.x(), p.y(), (*this)(p) + above};
  }

 private:
  ForestConfig config_;
  GradientNoise hills_, bumps_, rough_;
};

/// A closed curve around the middle whose radius swings between 0.2 and 0.4 of the size; its points
/// are kLoopStep apart.
std::vector<Vector2d> draw_loop(const ForestConfig& config, SequentialRandom& random) {
  const double mean = 0.3 * config.size_m;
  const double phase2 = random.uniform(0.0, 2.0 * pi), phase5 = random.uniform(0.0, 2.0 * pi);
  const auto count = static_cast<int>(std::ceil(2.0 * pi * mean / kLoopStep));
  std::vector<Vector2d> loop;
  for (int i = 0; i < count; ++i) {
    const double angle = 2.0 * pi * i / count;
    const double radius =
        mean * (1.0 + 0.2 * std::sin(2.0 * angle + phase2) + 0.1 * std::sin(5.0 * angle + phase5));
    loop.emplace_back(radius * std::cos(angle), radius * std::sin(angle));
  }
  loop.push_back(loop.front());
  return loop;
}

double distance_to(const std::vector<Vector2d>& line, const Vector2d& p) {
  double nearest = 1e9;
  for (std::size_t i = 1; i < line.size(); ++i) {
    const Vector2d step = line[i] - line[i - 1];
    const double t = std::clamp((p - line[i - 1]).dot(step) / step.squaredNorm(), 0.0, 1.0);
    nearest = std::min(nearest, (p - line[i - 1] - t * step).norm());
  }
  return nearest;
}

/// The loop above the ground: over the highest place within a step.
std::vector<Vector3d> route_above(const std::vector<Vector2d>& loop, const Ground& ground) {
  std::vector<Vector3d> route;
  for (const Vector2d& p : loop) {
    double highest = ground(p);
    for (int k = 0; k < 16; ++k) {
      const double angle = 2.0 * pi * k / 16;
      for (const double r : {0.5, 1.0, kLoopStep})
        highest = std::max(highest, ground(p + r * Vector2d(std::cos(angle), std::sin(angle))));
    }
    route.emplace_back(p.x(), p.y(), highest + kLoopHeight);
  }
  return route;
}

Vector2d draw_place(const ForestConfig& config, SequentialRandom& random) {
  const double half = 0.5 * config.size_m - kEdge;
  const double x = random.uniform(-half, half);
  return {x, random.uniform(-half, half)};
}

void add_trees(const ForestConfig& config, const Ground& ground, const std::vector<Vector2d>& loop,
               SequentialRandom& random, Plants& plants) {
  const auto count = static_cast<int>(config.trees_per_ha * config.size_m * config.size_m / 1e4);
  std::vector<Vector2d> standing;
  for (int i = 0; i < count; ++i) {
    const Vector2d place = draw_place(config, random);
    const double radius = 0.07 + 0.2 * random.uniform() * random.uniform();
    const bool is_conifer = random.uniform() < config.conifers;
    if (distance_to(loop, place) < kTrunkClearance + 1.5 * radius) continue;
    if (std::ranges::any_of(standing, [&](const Vector2d& other) {
          return (other - place).norm() < kBetweenTrees;
        }))
      continue;
    standing.push_back(place);
    add_tree(ground.at(place), radius, is_conifer, random, plants);
  }
}

/// Bushes, boulders and logs; returns the boulders.
world::TriangleMesh add_undergrowth(const ForestConfig& config, const Ground& ground,
                                    const std::vector<Vector2d>& loop, SequentialRandom& random,
                                    Plants& plants) {
  world::TriangleMesh stones;
  const auto count = static_cast<int>(config.undergrowth * 0.03 * config.size_m * config.size_m);
  for (int i = 0; i < count; ++i) {
    const Vector2d place = draw_place(config, random);
    const double radius = random.uniform(0.25, 0.7), kind = random.uniform();
    const double angle = random.uniform(0.0, 2.0 * pi);
    if (distance_to(loop, place) < kLowClearance + 2.0 * radius) continue;
    if (kind < 0.7) {
      add_bush(ground.at(place), radius, random, plants);
    } else if (kind < 0.9) {
      const auto seed = static_cast<std::uint64_t>(random.integer(0, 1 << 30));
      stones.append(boulder(ground.at(place), radius, seed));
    } else {
      const Vector2d half = 4.0 * radius * Vector2d(std::cos(angle), std::sin(angle));
      const double thick = 0.2 * radius;
      add_log(ground.at(place - half, thick), ground.at(place + half, thick), thick, plants);
    }
  }
  return stones;
}

}  // namespace

world::WorldModel make_forest(const ForestConfig& config, std::uint64_t seed) {
  SequentialRandom random(seed, stream_of("forest"));
  const Ground ground(config, seed);
  const std::vector<Vector2d> loop = draw_loop(config, random);
  const int cells = static_cast<int>(std::ceil(config.size_m / config.ground_step_m));
  world::WorldModel model{
      "forest",
      shape::grid(cells, cells,
                  [&](double u, double v) {
                    return ground.at(config.size_m * Vector2d(u - 0.5, v - 0.5));
                  }),
      {route_above(loop, ground)}};
  model.mesh.paint(kSoil.of("terrain"));
  Plants plants;
  add_trees(config, ground, loop, random, plants);
  world::TriangleMesh stones = add_undergrowth(config, ground, loop, random, plants);
  stones.paint(world::materials::kRock.of("boulder"));
  plants.wood.paint(kBark.of("trunk"));
  plants.leaves.paint(world::materials::kLeaf.of("leaves"));
  for (const world::TriangleMesh* part : {&stones, &plants.wood, &plants.leaves})
    if (!part->triangles.empty()) model.mesh.append(*part);
  return model;
}

}  // namespace lidarena::scenes
