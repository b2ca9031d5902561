// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/scenes/hall.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "lidarena/base/error.hpp"
#include "lidarena/base/random.hpp"
#include "lidarena/scenes/mesh_builder.hpp"

namespace lidarena::scenes {
namespace {

using Eigen::Vector3d;

constexpr double kCrossAisle = 4.5;   // m, between the racks and the walls at the ends
constexpr double kRackDepth = 1.1;    // m
constexpr double kBay = 2.8;          // m, between the uprights of a rack
constexpr double kShelf = 1.6;        // m, from shelf to shelf
constexpr double kSteel = 0.09;       // m, thickness of uprights and shelves' beams
constexpr double kPlate = 0.25;       // m, thickness of floor, walls and roof
constexpr double kTruss = 6.0;        // m, from truss to truss
constexpr double kTrussHeight = 0.9;  // m
constexpr double kAislePoint = 2.5;   // m, between the route's points

struct HallSize {
  explicit HallSize(const HallConfig& config)
      : length(config.length_m),
        width((config.rows + 1) * config.aisle_m + config.rows * kRackDepth),
        pitch(config.aisle_m + kRackDepth) {}
  double length, width, pitch;
  /// Center line of aisle i.
  double aisle(const HallConfig& config, int i) const { return 0.5 * config.aisle_m + i * pitch; }
};

world::TriangleMesh shell(const HallConfig& config, const HallSize& size) {
  const Vector3d low(-kPlate, -kPlate, -kPlate);
  const Vector3d high(size.length + kPlate, size.width + kPlate, config.height_m + kPlate);
  world::TriangleMesh mesh;
  for (int axis = 0; axis < 3; ++axis) {
    for (const bool upper : {false, true}) {
      Vector3d from = low, to = high;
      (upper ? from : to)[axis] = upper ? high[axis] - kPlate : low[axis] + kPlate;
      const char* const object = axis != 2 ? "wall" : upper ? "roof" : "floor";
      mesh.append(shape::painted(shape::box(from, to), world::materials::kPlaster.of(object)));
    }
  }
  return mesh;
}

/// Two chords across the hall and diagonals between them.
world::TriangleMesh truss(const HallConfig& config, const HallSize& size, double x) {
  const double top = config.height_m - 0.05, bottom = config.height_m - kTrussHeight;
  world::TriangleMesh mesh =
      shape::box({x - 0.06, 0, bottom - 0.12}, {x + 0.06, size.width, bottom});
  mesh.append(shape::box({x - 0.06, 0, top - 0.12}, {x + 0.06, size.width, top}));
  const int count = std::max(2, static_cast<int>(size.width / 1.5));
  for (int i = 0; i < count; ++i) {
    const double y = size.width * i / count, next = size.width * (i + 1) / count;
    const Vector3d a(x, y, i % 2 == 0 ? bottom : top), b(x, next, i % 2 == 0 ? top : bottom);
    mesh.append(shape::bar({a, b}, 0.04, 6));
  }
  return mesh;
}

/// What stands on a pallet at `place` (the middle of its lower face).
void add_goods(const Vector3d& place, SequentialRandom& random, world::TriangleMesh& wood,
               world::TriangleMesh& paper) {
  for (int slat = -2; slat <= 2; ++slat) {
    const Vector3d at = place + Vector3d(0.24 * slat, 0, 0.1);
    wood.append(shape::box(at - Vector3d(0.06, 0.45, 0.02), at + Vector3d(0.06, 0.45, 0.02)));
  }
  for (const double y : {-0.38, 0.0, 0.38}) {
    const Vector3d at = place + Vector3d(0, y, 0.04);
    wood.append(shape::box(at - Vector3d(0.54, 0.05, 0.04), at + Vector3d(0.54, 0.05, 0.04)));
  }
  const double kind = random.uniform();
  const Vector3d base = place + Vector3d(0, 0, 0.12);
  if (kind < 0.25) {  // a drum or two
    for (const double x : {-0.28, 0.28}) {
      const double height = random.uniform(0.6, 0.95);
      paper.append(shape::translated(shape::cylinder(0.27, height, 16), base + Vector3d(x, 0, 0)));
    }
    return;
  }
  const int along = random.integer(1, 3), layers = random.integer(1, 3);
  const double height = random.uniform(0.5, 1.1) / layers;
  for (int layer = 0; layer < layers; ++layer) {
    for (int i = 0; i < along; ++i) {
      const double x = 1.05 * ((i + 0.5) / along - 0.5) + random.uniform(-0.02, 0.02);
      const double half = 0.5 * 1.0 / along - 0.02, deep = random.uniform(0.3, 0.44);
      const world::TriangleMesh box =
          shape::box({-half, -deep, 0}, {half, deep, height - random.uniform(0.0, 0.03)});
      paper.append(
          shape::translated(shape::rotated(box, random.uniform(-0.05, 0.05), Vector3d::UnitZ()),
                            base + Vector3d(x, 0, layer * height)));
    }
  }
}

struct Fittings {
  world::TriangleMesh steel, wood, paper;
};

void add_rack(const HallConfig& config, double length, double y, SequentialRandom& random,
              Fittings& fittings) {
  const int bays = static_cast<int>((length - 2.0 * kCrossAisle) / kBay);
  const double begin = 0.5 * (length - bays * kBay), top = config.levels * kShelf;
  for (int bay = 0; bay <= bays; ++bay) {
    const double x = begin + bay * kBay;
    for (const double side : {-0.5, 0.5}) {
      const double at = y + side * (kRackDepth - kSteel);
      fittings.steel.append(shape::box({x - 0.5 * kSteel, at - 0.5 * kSteel, 0},
                                       {x + 0.5 * kSteel, at + 0.5 * kSteel, top}));
    }
    if (bay == bays) break;
    for (int level = 0; level < config.levels; ++level) {
      const double z = level * kShelf;
      if (level > 0) {
        for (const double side : {-0.5, 0.5}) {
          const double at = y + side * (kRackDepth - kSteel);
          fittings.steel.append(shape::box({x, at - 0.03, z - 0.12}, {x + kBay, at + 0.03, z}));
        }
        fittings.wood.append(shape::box({x, y - 0.45, z - 0.03}, {x + kBay, y + 0.45, z}));
      }
      for (const double place : {0.27, 0.73}) {
        if (random.uniform() < config.filling)
          add_goods({x + place * kBay, y, z}, random, fittings.wood, fittings.paper);
      }
    }
  }
}

/// Along aisle 0 away from the start, back along aisle 1 and so on, and home along the first wall.
std::vector<Vector3d> route_through(const HallConfig& config, const HallSize& size,
                                    SequentialRandom& random) {
  const double near = 0.5 * kCrossAisle, far = size.length - 0.5 * kCrossAisle;
  std::vector<Vector3d> corners;
  for (int i = 0; i <= config.rows; ++i) {
    const double y = size.aisle(config, i), z = random.uniform(1.3, 3.0);
    corners.emplace_back(i % 2 == 0 ? near : far, y, z);
    corners.emplace_back(i % 2 == 0 ? far : near, y, random.uniform(1.3, 3.0));
  }
  corners.push_back(corners.front());
  std::vector<Vector3d> route{corners.front()};
  for (std::size_t i = 1; i < corners.size(); ++i) {
    const Vector3d step = corners[i] - corners[i - 1];
    const int count = static_cast<int>(std::ceil(step.norm() / kAislePoint));
    for (int k = 1; k < count; ++k)
      route.emplace_back(corners[i - 1] + (static_cast<double>(k) / count) * step);
    route.push_back(corners[i]);
  }
  return route;
}

void check(const HallConfig& config) {
  if (config.rows % 2 == 0)
    throw InputError("hall", "has an even number of rows", "set rows to an odd number");
  if (config.levels * kShelf + kTrussHeight > config.height_m)
    throw InputError("hall", "has racks that reach into the trusses",
                     "increase height_m or reduce levels");
}

}  // namespace

world::WorldModel make_hall(const HallConfig& config, std::uint64_t seed) {
  check(config);
  SequentialRandom random(seed, stream_of("hall"));
  const HallSize size(config);
  world::WorldModel model{"hall", shell(config, size), {route_through(config, size, random)}};
  Fittings fittings;
  for (int row = 0; row < config.rows; ++row) {
    const double y = size.aisle(config, row) + 0.5 * size.pitch;
    add_rack(config, config.length_m, y, random, fittings);
  }
  fittings.steel.paint(world::materials::kMetal.of("rack"));
  for (double x = 0.5 * kTruss; x < size.length; x += kTruss)
    fittings.steel.append(
        shape::painted(truss(config, size, x), world::materials::kMetal.of("truss")));
  fittings.wood.paint(world::materials::kWood.of("rack"));
  fittings.paper.paint(world::materials::kPaper.of("goods"));
  for (const world::TriangleMesh* part : {&fittings.steel, &fittings.wood, &fittings.paper})
    if (!part->triangles.empty()) model.mesh.append(*part);
  return model;
}

}  // namespace lidarena::scenes
