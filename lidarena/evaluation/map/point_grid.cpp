// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/evaluation/map/point_grid.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

#include "lidarena/evaluation/map/parallel_sort.hpp"

namespace lidarena::evaluation {
namespace {

/// Squared distance, in cubes, of a cube from the nearest point of the cube in the middle.
int squared_gap(const map::Voxel& step) {
  return (step.cwiseAbs().array() - 1).max(0).square().sum();
}

}  // namespace

PointGrid::PointGrid(std::span<const Eigen::Vector3f> points, double cell, double reach,
                     const Parallel& parallel)
    : cell_(static_cast<float>(cell)),
      inverse_cell_(static_cast<float>(1.0 / cell)),
      beyond_reach_(std::nextafter(static_cast<float>(reach) * static_cast<float>(reach),
                                   std::numeric_limits<float>::infinity())),
      // slightly wider than the reach, because cubes are assigned with rounding
      inverse_coarse_(static_cast<float>(1.0 / (1.001 * std::max(2.0 * cell, reach)))) {
  const int rings = static_cast<int>(std::ceil(reach / cell));
  for (int x = -rings; x <= rings; ++x) {
    for (int y = -rings; y <= rings; ++y) {
      for (int z = -rings; z <= rings; ++z) steps_.push_back({map::Voxel(x, y, z)});
    }
  }
  std::ranges::stable_sort(steps_, {}, [](const Step& step) {
    return std::pair(squared_gap(step.offset), step.offset.squaredNorm());
  });
  for (Step& step : steps_) {
    // a little less, because a query may lie beside its cube by rounding
    step.min_squared_distance =
        0.999F * cell_ * cell_ * static_cast<float>(squared_gap(step.offset));
  }
  std::vector<std::pair<map::VoxelKey, std::uint32_t>> keyed;
  keyed.reserve(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!points[i].allFinite()) continue;
    keyed.emplace_back(map::voxel_key(map::voxel_of(points[i], inverse_cell_)),
                       static_cast<std::uint32_t>(i));
  }
  parallel_sort(std::span(keyed), parallel);
  points_.resize(static_cast<Eigen::Index>(keyed.size()), 3);
  for (std::uint32_t at = 0; at < keyed.size(); ++at) {
    const auto& [key, index] = keyed[at];
    cells_.try_emplace(key, at, at).first.value().second = at + 1;
    points_.row(at) = points[index].transpose().array();
  }
  // Cubes that hold points, then their neighbors.
  tsl::robin_set<map::VoxelKey, map::VoxelKeyHash> coarse;
  for (const auto& [key, index] : keyed)
    coarse.insert(map::voxel_key(map::voxel_of(points[index], inverse_coarse_)));
  for (const map::VoxelKey middle : coarse) {
    for (int x = -1; x <= 1; ++x) {
      for (int y = -1; y <= 1; ++y) {
        for (int z = -1; z <= 1; ++z) occupied_.insert(middle + map::voxel_key_step(x, y, z));
      }
    }
  }
}

float PointGrid::search(const Eigen::Vector3f& query, float best, float enough) const {
  if (!occupied_.contains(map::voxel_key(map::voxel_of(query, inverse_coarse_)))) return best;
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
  for (const Step& step : steps_) {
    if (step.min_squared_distance >= best) break;
    const auto& [x, y, z] = std::tuple(step.offset.x(), step.offset.y(), step.offset.z());
    if (gap(0, x) + gap(1, y) + gap(2, z) >= best) continue;
    const auto cell = cells_.find(key + map::voxel_key_step(x, y, z));
    if (cell == cells_.end()) continue;
    const auto [begin, end] = cell->second;
    const auto squares = [&, from = begin, count = end - begin](int axis) {
      return (points_.col(axis).segment(from, count) - query[axis]).square();
    };
    best = std::min(best, (squares(0) + (squares(1) + squares(2))).minCoeff());
    if (best < enough) break;
  }
  return best;
}

float PointGrid::nearest(const Eigen::Vector3f& query) const {
  const float squared = search(query, beyond_reach_, 0.0F);
  return squared < beyond_reach_ ? std::sqrt(squared) : std::numeric_limits<float>::infinity();
}

bool PointGrid::is_near(const Eigen::Vector3f& query) const {
  return search(query, beyond_reach_, beyond_reach_) < beyond_reach_;
}

}  // namespace lidarena::evaluation
