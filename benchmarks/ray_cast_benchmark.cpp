// SPDX-License-Identifier: BSD-3-Clause
// Rays and nearest points a second against the procedural cave (about 650,000 triangles), on one
// thread, with each ray caster of the build.
#include <benchmark/benchmark.h>

#include <vector>

#include "lidarena/base/random.hpp"
#include "lidarena/scenes/cave.hpp"
#include "lidarena/world/world.hpp"

namespace lidarena {
namespace {

/// Everything is made once; the cave takes seconds.
struct Scene {
  world::WorldModel model = scenes::make_cave(scenes::CaveConfig{}, 1);
  world::World world{model.mesh};
  world::World bvh_world{model.mesh, "mesh", world::RayCaster::kBvh};
  std::vector<world::Ray> rays;
  std::vector<Eigen::Vector3d> points;

  Scene() {
    SequentialRandom random(1);
    const auto& route = model.routes.front();
    constexpr int kRays = 100000;
    for (int i = 0; i < kRays; ++i) {
      // A thousand rays in every direction from each of a hundred places along the route.
      const auto& place = route[static_cast<std::size_t>(i / 1000) * route.size() / 100];
      const double x = random.normal(), y = random.normal(), z = random.normal();
      rays.push_back({place, Eigen::Vector3d(x, y, z).normalized().cast<float>()});
    }
    std::vector<world::Hit> hits(rays.size());
    world.cast(rays, 100.0, hits);
    for (std::size_t i = 0; i < rays.size(); ++i) {
      if (!hits[i].valid()) continue;
      // What a LiDAR with 2 cm of noise would put into a map.
      points.push_back(rays[i].origin + rays[i].direction.cast<double>() *
                                            (double{hits[i].range} + 0.02 * random.normal()));
    }
  }
};

const Scene& scene() {
  static const Scene scene;
  return scene;
}

const world::World& world(world::RayCaster caster) {
  return caster == world::RayCaster::kBvh ? scene().bvh_world : scene().world;
}

void cast(benchmark::State& state, world::RayCaster caster) {
  std::vector<world::Hit> hits(scene().rays.size());
  for (auto _ : state) world(caster).cast(scene().rays, 100.0, hits);
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(hits.size()));
}

void closest_points(benchmark::State& state, world::RayCaster caster) {
  const Parallel one_thread(1);
  std::vector<world::ClosestPoint> nearest(scene().points.size());
  for (auto _ : state) world(caster).closest_points(scene().points, 1.0, nearest, one_thread);
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(nearest.size()));
}

void build(benchmark::State& state, world::RayCaster caster) {
  for (auto _ : state) benchmark::DoNotOptimize(world::World(scene().model.mesh, "mesh", caster));
  state.counters["triangles"] = static_cast<double>(scene().model.mesh.triangles.size());
}

#if LIDARENA_EMBREE_MAJOR > 0
BENCHMARK_CAPTURE(cast, embree, world::RayCaster::kEmbree)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(closest_points, embree, world::RayCaster::kEmbree)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(build, embree, world::RayCaster::kEmbree)->Unit(benchmark::kMillisecond);
#endif
BENCHMARK_CAPTURE(cast, bvh, world::RayCaster::kBvh)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(closest_points, bvh, world::RayCaster::kBvh)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(build, bvh, world::RayCaster::kBvh)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace lidarena
