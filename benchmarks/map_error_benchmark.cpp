// SPDX-License-Identifier: BSD-3-Clause
// Error of a map of ten million points against a mesh of a million triangles (the cave with a finer
// grid), compared with direct Embree point queries on the same points in the same run.
#include <benchmark/benchmark.h>

#if LIDARENA_EMBREE_MAJOR >= 4
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

#include <cmath>
#include <vector>

#include "lidarena/base/random.hpp"
#include "lidarena/evaluation/map/map_error.hpp"
#include "lidarena/map/point_map.hpp"
#include "lidarena/scenes/cave.hpp"
#include "lidarena/world/world.hpp"

namespace lidarena {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

constexpr std::size_t kPoints = 10'000'000;
constexpr double kNoise_m = 0.02;
constexpr double kVoxel_m = 0.02;

/// Map as given to an evaluation: returns along the route with range noise, the first of each
/// voxel, in time order.
std::vector<Vector3f> make_map(const world::World& world, const std::vector<Vector3d>& route) {
  SequentialRandom random(1);
  map::PointMap map(kVoxel_m, kPoints);
  constexpr std::size_t kRays = 20'000;
  std::vector<world::Ray> rays(kRays);
  std::vector<world::Hit> hits(kRays);
  for (std::size_t place = 0; map.size() < kPoints; ++place) {
    for (world::Ray& ray : rays) {
      const Vector3d direction(random.normal(), random.normal(), random.normal());
      ray = {route[place % route.size()], direction.normalized().cast<float>()};
    }
    world.cast(rays, 30.0, hits);
    for (std::size_t i = 0; i < kRays && map.size() < kPoints; ++i) {
      if (!hits[i].valid()) continue;
      const double range = double{hits[i].range} + kNoise_m * random.normal();
      map.insert((rays[i].origin + range * rays[i].direction.cast<double>()).cast<float>());
    }
  }
  return map.take();
}

scenes::CaveConfig fine_cave() {
  scenes::CaveConfig config;
  config.voxel_size_m = 0.1;
  return config;
}

struct Scene {
  world::WorldModel model = scenes::make_cave(fine_cave(), 1);
  world::World world{model.mesh};
  std::vector<Vector3f> map = make_map(world, model.routes.front());
};

const Scene& scene() {
  static const Scene scene;
  return scene;
}

void report(benchmark::State& state, std::size_t points) {
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(points));
  state.counters["points"] = static_cast<double>(points);
  state.counters["triangles"] = static_cast<double>(scene().model.mesh.triangles.size());
}

void map_error_of_ten_million(benchmark::State& state) {
  const Parallel parallel(static_cast<int>(state.range(0)));
  const std::vector<Vector3f>& map = scene().map;
  for (auto _ : state) {
    const evaluation::MapError error =
        evaluation::map_error(map, Pose::Identity(), scene().world, parallel);
    state.counters["rmse_cm"] = 100.0 * error.distance_m.rmse;
  }
  report(state, map.size());
}
BENCHMARK(map_error_of_ten_million)
    ->Arg(1)
    ->Arg(2)
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime()
    ->UseRealTime();

/// Direct use of Embree as in its manual: single precision, one query per point, closest triangle.
struct Bare {
  RTCDevice device = rtcNewDevice(nullptr);
  RTCScene scene = rtcNewScene(device);
  std::vector<Vector3f> vertices;
  std::vector<world::Triangle> triangles;

  explicit Bare(const world::TriangleMesh& mesh) : triangles(mesh.triangles) {
    for (const Vector3d& v : mesh.vertices) vertices.push_back(v.cast<float>());
    vertices.emplace_back(0, 0, 0);  // Embree reads 16 bytes of the last one
    RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                               vertices.data(), 0, sizeof(Vector3f), vertices.size() - 1);
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                               triangles.data(), 0, sizeof(world::Triangle), triangles.size());
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene, geometry);
    rtcReleaseGeometry(geometry);
    rtcCommitScene(scene);
  }
  ~Bare() {
    rtcReleaseScene(scene);
    rtcReleaseDevice(device);
  }
  Bare(const Bare&) = delete;
  Bare& operator=(const Bare&) = delete;
};

struct Best {
  const Bare& bare;
  Vector3f point;
  float distance = std::numeric_limits<float>::infinity();
};

Vector3f on_segment(const Vector3f& p, const Vector3f& a, const Vector3f& b) {
  const Vector3f ab = b - a;
  return a + std::clamp(ab.dot(p - a) / ab.squaredNorm(), 0.0F, 1.0F) * ab;
}

Vector3f on_triangle(const Vector3f& p, const Vector3f& a, const Vector3f& b, const Vector3f& c) {
  const Vector3f n = (b - a).cross(c - a);
  const bool ab = n.dot((b - a).cross(p - a)) >= 0.0F;
  const bool bc = n.dot((c - b).cross(p - b)) >= 0.0F;
  const bool ca = n.dot((a - c).cross(p - c)) >= 0.0F;
  if (ab && bc && ca) return p - n * (n.dot(p - a) / n.squaredNorm());
  Vector3f best = on_segment(p, a, b);
  for (const Vector3f& q : {on_segment(p, b, c), on_segment(p, c, a)}) {
    if ((q - p).squaredNorm() < (best - p).squaredNorm()) best = q;
  }
  return best;
}

bool keep_nearest(RTCPointQueryFunctionArguments* args) {
  auto& best = *static_cast<Best*>(args->userPtr);
  const auto& [a, b, c] = best.bare.triangles[args->primID];
  const auto& v = best.bare.vertices;
  const float distance = (on_triangle(best.point, v[a], v[b], v[c]) - best.point).norm();
  if (distance >= best.distance) return false;
  best.distance = distance;
  args->query->radius = distance;
  return true;
}

void bare_embree_point_queries(benchmark::State& state) {
  static const Bare bare(scene().model.mesh);
  constexpr std::size_t kStride = 10;  // the first tenth of the points, so that neighbors are kept
  const std::vector<Vector3f>& map = scene().map;
  const std::size_t count = map.size() / kStride;
  for (auto _ : state) {
    double squares = 0.0;
    for (std::size_t i = 0; i < count; ++i) {
      Best best{bare, map[i]};
      RTCPointQuery query{};
      query.x = map[i].x();
      query.y = map[i].y();
      query.z = map[i].z();
      query.radius = std::numeric_limits<float>::infinity();
      RTCPointQueryContext context;
      rtcInitPointQueryContext(&context);
      rtcPointQuery(bare.scene, &query, &context, keep_nearest, &best);
      squares += double{best.distance} * double{best.distance};
    }
    state.counters["rmse_cm"] = 100.0 * std::sqrt(squares / static_cast<double>(count));
  }
  report(state, count);
}
BENCHMARK(bare_embree_point_queries)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace lidarena
