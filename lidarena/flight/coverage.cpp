// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/flight/coverage.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "lidarena/base/random.hpp"

namespace lidarena::flight {

using Eigen::Vector3d;

std::vector<SurfaceSample> sample_surface(const world::TriangleMesh& mesh, std::size_t count) {
  std::vector<double> area_until;  // cumulative area up to and including each triangle
  area_until.reserve(mesh.triangles.size());
  double area = 0.0;
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    area += 0.5 * mesh.cross(i).norm();
    area_until.push_back(area);
  }
  const CounterRandom random(0, stream_of("surface samples"));
  std::vector<SurfaceSample> samples;
  for (std::size_t k = 0; k < count; ++k) {
    const double share = (static_cast<double>(k) + random.uniform(k)) / static_cast<double>(count);
    const auto found = std::upper_bound(area_until.begin(), area_until.end() - 1, share * area);
    const auto index = static_cast<std::size_t>(found - area_until.begin());
    const auto& [a, b, c] = mesh.triangles[index];
    const double u = std::sqrt(random.uniform(k, 1));  // uniform over the triangle
    const double v = random.uniform(k, 2);
    samples.push_back(
        {(1.0 - u) * mesh.vertices[a] + u * (1.0 - v) * mesh.vertices[b] + u * v * mesh.vertices[c],
         static_cast<std::uint32_t>(index)});
  }
  return samples;
}

namespace {

/// Marks the samples that are visible from `place` and not yet marked.
void mark_visible(const world::World& world, const Vector3d& place,
                  std::span<const SurfaceSample> samples, double range_m, Seen& seen) {
  constexpr double kTolerance = 0.002;  // m; rounding error of the ray caster in a world of 1 km
  std::vector<world::Ray> rays;
  std::vector<std::size_t> index;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const Vector3d offset = samples[i].point - place;
    const double length = offset.norm();
    if (seen[i] != 0 || length > range_m || length < kTolerance) continue;
    rays.push_back({place, (offset / length).cast<float>()});
    index.push_back(i);
  }
  std::vector<world::Hit> hits(rays.size());
  world.cast(rays, range_m + 1.0, hits);
  for (std::size_t k = 0; k < rays.size(); ++k) {
    const SurfaceSample& sample = samples[index[k]];
    const double length = (sample.point - place).norm();
    if (hits[k].triangle == sample.triangle || hits[k].range > length - kTolerance)
      seen[index[k]] = 1;
  }
}

}  // namespace

Seen seen_from(const world::World& world, const Vector3d& place,
               std::span<const SurfaceSample> samples, double range_m) {
  Seen seen(samples.size(), 0);
  mark_visible(world, place, samples, range_m, seen);
  return seen;
}

std::vector<Seen> seen_from_each(const world::World& world, std::span<const Vector3d> places,
                                 std::span<const SurfaceSample> samples, double range_m,
                                 const Parallel& parallel) {
  std::vector<Seen> views(places.size());
  parallel.for_each(places.size(), 4, [&](std::size_t i) {
    views[i] = seen_from(world, places[i], samples, range_m);
  });
  return views;
}

Seen seen_along(const world::World& world, const Flight& flight,
                std::span<const SurfaceSample> samples, double range_m, double spacing_m) {
  Seen seen(samples.size(), 0);
  Vector3d last = Vector3d::Constant(std::numeric_limits<double>::infinity());
  for (Time t{0}; t <= flight.duration(); t += std::chrono::milliseconds(20)) {
    const Vector3d here = flight.pose_at(t).translation();
    if ((here - last).norm() < spacing_m) continue;
    mark_visible(world, here, samples, range_m, seen);
    last = here;
  }
  return seen;
}

void add_seen(Seen& seen, const Seen& other) {
  for (std::size_t i = 0; i < seen.size(); ++i) seen[i] |= other[i];
}

std::size_t count_seen(const Seen& seen) {
  return static_cast<std::size_t>(std::count(seen.begin(), seen.end(), 1));
}

std::vector<std::size_t> choose_views(std::span<const Seen> views, double share) {
  std::vector<std::size_t> chosen;
  if (views.empty()) return chosen;
  Seen all(views.front().size(), 0);
  for (const Seen& view : views) add_seen(all, view);
  const double wanted = share * static_cast<double>(count_seen(all));
  Seen seen(all.size(), 0);
  for (std::size_t count = 0; static_cast<double>(count) < wanted; count = count_seen(seen)) {
    std::size_t best = 0, best_gain = 0;
    for (std::size_t v = 0; v < views.size(); ++v) {
      std::size_t gain = 0;
      for (std::size_t i = 0; i < seen.size(); ++i) gain += views[v][i] > seen[i] ? 1U : 0U;
      if (gain > best_gain) {
        best_gain = gain;
        best = v;
      }
    }
    chosen.push_back(best);
    add_seen(seen, views[best]);
  }
  return chosen;
}

}  // namespace lidarena::flight
