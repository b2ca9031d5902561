// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/evaluation/map/completeness.hpp"

#include <algorithm>
#include <cmath>

#include "lidarena/base/random.hpp"

namespace lidarena::evaluation {

using Eigen::Vector3d;
using Eigen::Vector3f;

namespace {

constexpr std::uint64_t kSeed = 1;
constexpr double kGridCell_m = 0.10;
constexpr double kHitCell_m = 0.04;  // a sample within 2 cm is in few of them

/// Triangle t has the samples [first[t], first[t + 1]): systematic sampling of the cumulative area.
std::vector<std::size_t> first_samples(const world::TriangleMesh& mesh) {
  std::vector<std::size_t> first{0};
  double area = 0.0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    area += 0.5 * mesh.cross(t).norm();
    first.push_back(static_cast<std::size_t>(area * SurfaceSamples::kPerSquareMeter + 0.5));
  }
  return first;
}

/// Sample `k` of the `count` of a triangle: one strip of equal area per sample, parallel to one
/// side, and along the strips multiples of the golden ratio.
Vector3d sample_of(const world::TriangleMesh& mesh, std::size_t triangle, std::size_t k,
                   std::size_t count, double u, double shift) {
  constexpr double kGolden = 0.6180339887498949;
  const auto index = static_cast<double>(k);
  const double along = std::sqrt((index + u) / static_cast<double>(count));
  const double turns = shift + index * kGolden;
  const double across = turns - std::floor(turns);
  const auto& [a, b, c] = mesh.triangles[triangle];
  const auto& v = mesh.vertices;
  return (1.0 - along) * v[a] + along * ((1.0 - across) * v[b] + across * v[c]);
}

}  // namespace

SurfaceSamples seen_samples(const world::World& world, const ObservedSurface& seen,
                            const Parallel& parallel) {
  const world::TriangleMesh& mesh = world.mesh();
  const Vector3d center = center_of(world);
  const PointGrid hits(seen.hits, kHitCell_m, SurfaceSamples::kSeen_m, parallel);
  const std::vector<std::size_t> first = first_samples(mesh);
  const CounterRandom random(kSeed, stream_of("seen_samples"));
  constexpr std::size_t kGrain = 64;  // triangles
  SurfaceSamples samples;
  samples.offsets = parallel.reduce(
      mesh.triangles.size(), kGrain, std::vector<Vector3f>{},
      [&](std::size_t begin, std::size_t end) {
        std::vector<Vector3f> kept;
        for (std::size_t t = begin; t < end; ++t) {
          const std::size_t count = first[t + 1] - first[t];
          const double shift = random.uniform(t, 1);
          for (std::size_t k = 0; k < count; ++k) {
            const double u = random.uniform(first[t] + k);
            const Vector3d sample = sample_of(mesh, t, k, count, u, shift);
            const Vector3f offset = (sample - center).cast<float>();
            if (hits.is_near(offset)) kept.push_back(offset);
          }
        }
        return kept;
      },
      [](std::vector<Vector3f>& all, const std::vector<Vector3f>& part) {
        all.insert(all.end(), part.begin(), part.end());
      });
  return samples;
}

PointGrid completeness_grid(std::span<const Vector3f> map, const Parallel& parallel) {
  return {map, kGridCell_m, Completeness::kWithin_m.back(), parallel};
}

Completeness completeness(const SurfaceSamples& samples, const PointGrid& grid,
                          std::span<const PointScore> scores, const Pose& mesh_from_map,
                          const world::World& world, const Parallel& parallel) {
  Completeness result;
  result.samples = samples.offsets.size();
  result.seen_m2 = samples.area_m2();
  const Pose map_from_mesh = mesh_from_map.inverse();
  const Vector3d center = center_of(world);
  constexpr std::size_t kGrain = 4096;
  std::vector<float> nearest(samples.offsets.size());
  parallel.for_each(nearest.size(), kGrain, [&](std::size_t i) {
    const Vector3d in_map = map_from_mesh * (center + samples.offsets[i].cast<double>());
    nearest[i] = grid.nearest(in_map.cast<float>());
  });
  const auto percent = [](std::ptrdiff_t part, std::size_t of) {
    return of == 0 ? 0.0 : 100.0 * static_cast<double>(part) / static_cast<double>(of);
  };
  for (std::size_t row = 0; row < Completeness::kWithin_m.size(); ++row) {
    const double within = Completeness::kWithin_m[row];
    const double precision =
        percent(std::count_if(scores.begin(), scores.end(),
                              [&](const PointScore& score) { return score.distance <= within; }),
                scores.size());
    const double recall = percent(
        std::count_if(nearest.begin(), nearest.end(), [&](float d) { return double{d} <= within; }),
        nearest.size());
    const double sum = precision + recall;
    result.rows.push_back(
        {within, precision, recall, sum > 0.0 ? 2.0 * precision * recall / sum : 0.0});
  }
  return result;
}

}  // namespace lidarena::evaluation
