// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/scenes/mine.hpp"

#include <cmath>
#include <functional>
#include <numbers>

#include "lidarena/base/random.hpp"
#include "lidarena/scenes/cave_field.hpp"
#include "lidarena/scenes/mesh_builder.hpp"
#include "lidarena/scenes/mine_field.hpp"
#include "lidarena/scenes/mine_plan.hpp"
#include "lidarena/scenes/surface_nets.hpp"

namespace lidarena::scenes {
namespace {

using Eigen::Vector3d;

constexpr double kPost = 0.18;       // m, thickness of a support's posts and beam
constexpr double kInset = 0.12;      // m, of a post's axis from the nominal wall
constexpr double kBeamBelow = 0.35;  // m, of a beam's lower face from the nominal roof
constexpr double kInRock = 0.3;      // m, by which posts and beams stand in the rock
constexpr double kBetween = 5.0;     // m, from support to support
constexpr double kPipeRadius = 0.08, kPipeInset = 0.25, kPipeHeight = 0.5;  // m

/// Places shapes in the frame of a drift: x along it from `from`, y to the left, z up.
struct DriftFrame {
  explicit DriftFrame(const Drift& drift)
      : from(drift.from),
        step(drift.to - drift.from),
        length(step.head<2>().norm()),
        yaw(std::atan2(step.y(), step.x())) {}
  double floor(double x) const { return x / length * step.z(); }
  world::TriangleMesh placed(const world::TriangleMesh& mesh) const {
    return shape::translated(shape::rotated(mesh, yaw, Vector3d::UnitZ()), from);
  }
  Vector3d from, step;
  double length, yaw;
};

world::TriangleMesh support(const Drift& drift, const DriftFrame& frame, double x) {
  const double half = 0.5 * drift.width, floor = frame.floor(x);
  const double beam = floor + drift.height - kBeamBelow;
  world::TriangleMesh mesh = shape::box({x - 0.5 * kPost, -half - kInRock, beam},
                                        {x + 0.5 * kPost, half + kInRock, beam + kPost});
  for (const double side : {-1.0, 1.0}) {
    const double y = side * (half - kInset);
    mesh.append(shape::box({x - 0.5 * kPost, y - 0.5 * kPost, floor - kInRock},
                           {x + 0.5 * kPost, y + 0.5 * kPost, beam}));
  }
  return frame.placed(mesh);
}

/// Supports and a pipe along one wall, away from the junctions.
void fit_gallery(const Drift& drift, SequentialRandom& random, world::TriangleMesh& mesh) {
  const DriftFrame frame(drift);
  const double begin = 0.5 * drift.width + 2.5, end = frame.length - begin;
  if (end < begin) return;
  for (double x = begin + random.uniform(0.0, 2.0); x <= end; x += kBetween) {
    world::TriangleMesh wood = support(drift, frame, x);
    wood.paint(world::materials::kWood.of("support"));
    mesh.append(wood);
  }
  const double side = random.uniform() < 0.5 ? -1.0 : 1.0;
  const double y = side * (0.5 * drift.width - kPipeInset);
  world::TriangleMesh pipe = frame.placed(shape::bar(
      {{begin, y, frame.floor(begin) + kPipeHeight}, {end, y, frame.floor(end) + kPipeHeight}},
      kPipeRadius, 12));
  pipe.paint(world::materials::kMetal.of("pipe"));
  mesh.append(pipe);
}

void fill_chamber(const Drift& chamber, SequentialRandom& random, world::TriangleMesh& mesh) {
  const DriftFrame frame(chamber);
  for (int i = random.integer(2, 4); i > 0; --i) {
    const Vector3d size(random.uniform(0.4, 1.0), random.uniform(0.4, 0.8),
                        random.uniform(0.4, 1.2));
    const double x = random.uniform(0.0, frame.length + 0.3 * chamber.width);
    const double y = random.uniform(-0.35, 0.35) * chamber.width;
    world::TriangleMesh crate =
        shape::rotated(shape::box({-0.5 * size.x(), -0.5 * size.y(), -0.1},
                                  0.5 * size.cwiseProduct(Vector3d(1, 1, 2))),
                       random.uniform(0.0, std::numbers::pi), Vector3d::UnitZ());
    crate = frame.placed(shape::translated(crate, {x, y, 0.0}));
    crate.paint(world::materials::kWood.of("crate"));
    mesh.append(crate);
  }
}

}  // namespace

world::WorldModel make_mine(const MineConfig& config, std::uint64_t seed) {
  const MinePlan plan = plan_mine(config, seed);
  const MineField rock(plan, config, seed);
  SparseField samples = rock.sample();
  make_well_composed(samples);
  world::WorldModel model{"mine", surface_net(samples), {mine_route(plan)}};
  project_onto_surface(model.mesh, std::cref(rock), config.voxel_size_m);
  model.mesh.paint(world::materials::kRock.of("rock"));
  SequentialRandom random(seed, stream_of("mine fittings"));
  for (const Gallery& gallery : plan.galleries) {
    const bool is_supported = random.uniform() < config.supports;
    if (is_supported) fit_gallery(gallery.drift, random, model.mesh);
  }
  for (std::size_t i = 1; i < plan.chambers.size(); i += 2)
    fill_chamber(plan.chambers[i], random, model.mesh);
  return model;
}

}  // namespace lidarena::scenes
