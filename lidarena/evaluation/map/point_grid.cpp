// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/evaluation/map/point_grid.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "lidarena/evaluation/map/parallel_sort.hpp"

namespace lidarena::evaluation {
namespace {

std::vector<map::Voxel> steps_within(int rings) {
  std::vector<map::Voxel> steps;
  for (int x = -rings; x <= rings; ++x) {
    for (int y = -rings; y <= rings; ++y) {
      for (int z = -rings; z <= rings; ++z) steps.emplace_back(x, y, z);
    }
  }
  std::stable_sort(steps.begin(), steps.end(), [](const map::Voxel& a, const map::Voxel& b) {
    return a.squaredNorm() < b.squaredNorm();
  });
  return steps;
}

}  // namespace

PointGrid::PointGrid(std::span<const Eigen::Vector3f> points, double cell, double reach,
                     const Parallel& parallel)
    : cell_(static_cast<float>(cell)),
      inverse_cell_(static_cast<float>(1.0 / cell)),
      reach_(static_cast<float>(reach)),
      steps_(steps_within(static_cast<int>(std::ceil(reach / cell)))) {
  std::vector<std::pair<map::VoxelKey, std::uint32_t>> keyed;
  keyed.reserve(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!points[i].allFinite()) continue;
    keyed.emplace_back(map::voxel_key(map::voxel_of(points[i], inverse_cell_)),
                       static_cast<std::uint32_t>(i));
  }
  parallel_sort(std::span(keyed), parallel);
  points_.reserve(keyed.size());
  for (const auto& [key, index] : keyed) {
    const auto at = static_cast<std::uint32_t>(points_.size());
    cells_.try_emplace(key, at, at).first.value().second = at + 1;
    points_.push_back(points[index]);
  }
}

float PointGrid::nearest(const Eigen::Vector3f& query) const {
  const map::Voxel voxel = map::voxel_of(query, inverse_cell_);
  const map::VoxelKey key = map::voxel_key(voxel);
  const Eigen::Array3f above = query.array() - voxel.cast<float>().array() * cell_;
  const Eigen::Array3f below = cell_ - above;
  // squared minimum distance along an axis to the cubes that are `step` away
  const auto gap = [&](int axis, int step) {
    if (step == 0) return 0.0F;
    const float to_face = step < 0 ? above[axis] : below[axis];
    const float d = to_face + cell_ * static_cast<float>(std::abs(step) - 1);
    return d * d;
  };
  float best = std::nextafter(reach_ * reach_, std::numeric_limits<float>::infinity());
  bool found = false;
  for (const map::Voxel& step : steps_) {
    if (gap(0, step.x()) + gap(1, step.y()) + gap(2, step.z()) >= best) continue;
    const auto cell = cells_.find(key + map::voxel_key_step(step.x(), step.y(), step.z()));
    if (cell == cells_.end()) continue;
    for (std::uint32_t i = cell->second.first; i < cell->second.second; ++i) {
      const float d2 = (points_[i] - query).squaredNorm();
      if (d2 >= best) continue;
      best = d2;
      found = true;
    }
  }
  return found ? std::sqrt(best) : std::numeric_limits<float>::infinity();
}

}  // namespace lidarena::evaluation
