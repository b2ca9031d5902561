// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/evaluation/map/point_scores.hpp"

#include <algorithm>
#include <limits>

namespace lidarena::evaluation {

using Eigen::Vector3d;

namespace {

constexpr std::size_t kChunk = std::size_t{1} << 18U;  // points per batch; limits the memory

PointScore score_of(const Vector3d& point, const world::ClosestPoint& nearest,
                    const world::TriangleMesh& mesh, const Vector3d& center) {
  PointScore score;
  score.distance = nearest.distance;
  score.foot_offset = (nearest.point - center).cast<float>();
  score.triangle = nearest.triangle;
  const Vector3d normal = mesh.cross(nearest.triangle).normalized();
  score.height = static_cast<float>(normal.dot(point - nearest.point));
  return score;
}

}  // namespace

Vector3d center_of(const world::World& world) { return world.mesh().bounds().center(); }

std::vector<PointScore> score_points(std::span<const Eigen::Vector3f> map, const MortonOrder& order,
                                     const Pose& mesh_from_map, const world::World& world,
                                     const Parallel& parallel) {
  const std::size_t count = order.entries.size();
  const Vector3d center = center_of(world);
  std::vector<PointScore> scores(count);
  std::vector<Vector3d> moved(std::min(kChunk, count));
  std::vector<world::ClosestPoint> nearest(moved.size());
  for (std::size_t begin = 0; begin < count; begin += kChunk) {
    const std::size_t length = std::min(kChunk, count - begin);
    constexpr std::size_t kGrain = 4096;
    parallel.for_each(length, kGrain, [&](std::size_t k) {
      moved[k] = mesh_from_map * map[order.entries[begin + k].index].cast<double>();
    });
    world.closest_points(std::span(moved).first(length), std::numeric_limits<double>::infinity(),
                         nearest, parallel);
    parallel.for_each(length, kGrain, [&](std::size_t k) {
      scores[begin + k] = score_of(moved[k], nearest[k], world.mesh(), center);
    });
  }
  return scores;
}

}  // namespace lidarena::evaluation
