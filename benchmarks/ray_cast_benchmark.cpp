// SPDX-License-Identifier: BSD-3-Clause
// Rays and nearest points a second against the procedural cave (about 200,000 triangles), on one
// thread.
#include <benchmark/benchmark.h>

#include <vector>

#include "lidarena/base/random.hpp"
#include "lidarena/world/cave.hpp"
#include "lidarena/world/world.hpp"

namespace lidarena {
namespace {

/// Everything is made once; the cave takes seconds.
struct Scene {
  WorldModel model = make_cave(CaveConfig{}, 1);
  World world{model.mesh};
  std::vector<Ray> rays;
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
    std::vector<Hit> hits(rays.size());
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

void cast(benchmark::State& state) {
  std::vector<Hit> hits(scene().rays.size());
  for (auto _ : state) scene().world.cast(scene().rays, 100.0, hits);
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(hits.size()));
}
BENCHMARK(cast)->Unit(benchmark::kMillisecond);

void closest_points(benchmark::State& state) {
  const Parallel one_thread(1);
  std::vector<ClosestPoint> nearest(scene().points.size());
  for (auto _ : state) scene().world.closest_points(scene().points, 1.0, nearest, one_thread);
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(nearest.size()));
}
BENCHMARK(closest_points)->Unit(benchmark::kMillisecond);

void build(benchmark::State& state) {
  for (auto _ : state) benchmark::DoNotOptimize(World(scene().model.mesh));
  state.counters["triangles"] = static_cast<double>(scene().model.mesh.triangles.size());
}
BENCHMARK(build)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace lidarena
