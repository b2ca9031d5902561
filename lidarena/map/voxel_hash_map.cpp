// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/map/voxel_hash_map.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>

#include "lidarena/base/error.hpp"

namespace lidarena::map {

namespace {

struct Step {
  int dx, dy, dz;
};

/// The cell itself and its 26 neighbors, those with a common face first, then edge, then corner.
constexpr std::array<Step, 27> make_steps() {
  std::array<Step, 27> steps{};
  std::size_t next = 0;
  for (int manhattan = 0; manhattan <= 3; ++manhattan) {
    for (int i = 0; i < 27; ++i) {
      const Step step{i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1};
      const int distance = step.dx * step.dx + step.dy * step.dy + step.dz * step.dz;
      if (distance == manhattan) steps[next++] = step;
    }
  }
  return steps;
}
constexpr std::array<Step, 27> kSteps = make_steps();

}  // namespace

VoxelHashMap::VoxelHashMap(const Options& options)
    : options_(options),
      size_m_(static_cast<float>(options.voxel_size)),
      inverse_size_(static_cast<float>(1.0 / options.voxel_size)),
      squared_spacing_(static_cast<float>(options.min_spacing * options.min_spacing)) {
  if (!(options.voxel_size > 0.0)) throw InputError("voxel_size", "must be above 0 m");
  if (options.max_points < 1 || options.max_points > 4096)
    throw InputError("max_points", "must be 1 to 4096 points per cell");
}

bool VoxelHashMap::insert(const Eigen::Vector3f& point) {
  if (!point.allFinite()) return false;
  Cell& cell = cells_[voxel_key(cell_of(point))];
  if (cell.count == options_.max_points) return false;
  const std::span<const Eigen::Vector3f> present(cell.points, cell.count);
  const bool crowded = std::any_of(present.begin(), present.end(), [&](const auto& other) {
    return (other - point).squaredNorm() < squared_spacing_;
  });
  if (crowded) return false;
  append(cell, point);
  return true;
}

void VoxelHashMap::insert(std::span<const Eigen::Vector3f> points) {
  for (const Eigen::Vector3f& point : points) insert(point);
}

void VoxelHashMap::append(Cell& cell, const Eigen::Vector3f& point) {
  if (cell.points == nullptr) {
    cell.points = blocks_.allocate(cell.level);
  } else if (cell.count == PointBlocks::capacity(cell.level)) {
    Eigen::Vector3f* const larger = blocks_.allocate(cell.level + 1);
    std::copy_n(cell.points, cell.count, larger);
    blocks_.release(cell.points, cell.level);
    cell.points = larger;
    ++cell.level;
  }
  cell.points[cell.count++] = point;
  ++size_;
}

void VoxelHashMap::remove_far(const Eigen::Vector3f& center, double radius) {
  const auto squared_radius = static_cast<float>(radius * radius);
  for (auto it = cells_.begin(); it != cells_.end();) {
    Cell& cell = it.value();
    if ((cell.points[0] - center).squaredNorm() < squared_radius) {
      ++it;
      continue;
    }
    blocks_.release(cell.points, cell.level);
    size_ -= cell.count;
    it = cells_.erase(it);
  }
}

std::optional<Neighbor> VoxelHashMap::nearest(const Eigen::Vector3f& query,
                                              float max_distance) const {
  if (!query.allFinite()) return std::nullopt;
  const Voxel voxel = cell_of(query);
  const VoxelKey key = voxel_key(voxel);
  // Squared distance along each axis to the cells below, here and above: a cell that begins beyond
  // the best distance so far need not be searched.
  const bool wide = options_.rounding == VoxelRounding::kTruncate;
  const Eigen::Array3i index = voxel.array();
  const Eigen::Array3i lower = wide ? Eigen::Array3i(index - (index <= 0).cast<int>()) : index;
  const Eigen::Array3i upper = wide ? Eigen::Array3i(index + (index >= 0).cast<int>()) : index + 1;
  const Eigen::Array3f low = (query.array() - lower.cast<float>() * size_m_).square();
  const Eigen::Array3f high = (upper.cast<float>() * size_m_ - query.array()).square();
  const auto gap = [&](int axis, int step) {
    return step == 0 ? 0.0F : (step < 0 ? low[axis] : high[axis]);
  };
  Neighbor best;
  best.squared_distance = max_distance * max_distance;
  bool found_one = false;
  for (const auto& [dx, dy, dz] : kSteps) {
    if (gap(0, dx) + gap(1, dy) + gap(2, dz) >= best.squared_distance) continue;
    const auto found = cells_.find(key + voxel_key_step(dx, dy, dz));
    if (found == cells_.end()) continue;
    const Cell& cell = found->second;
    for (std::size_t i = 0; i < cell.count; ++i) {
      const float squared_distance = (cell.points[i] - query).squaredNorm();
      if (squared_distance >= best.squared_distance) continue;
      best = {cell.points[i], squared_distance};
      found_one = true;
    }
  }
  return found_one ? std::optional(best) : std::nullopt;
}

namespace {

/// The nearest points so far, as a heap with the farthest of them on top.
class NearestFew {
 public:
  NearestFew(std::span<Neighbor> out, float radius) : out_(out), bound_(radius * radius) {}

  /// Points at this squared distance or beyond are ignored.
  float bound() const { return bound_; }
  std::size_t count() const { return count_; }

  void offer(const Eigen::Vector3f& point, float squared_distance) {
    if (squared_distance >= bound_) return;
    if (count_ < out_.size()) {
      out_[count_++] = {point, squared_distance};
      if (count_ < out_.size()) return;
      std::make_heap(out_.begin(), out_.end(), [](const Neighbor& a, const Neighbor& b) {
        return a.squared_distance < b.squared_distance;
      });
    } else {
      replace_farthest({point, squared_distance});
    }
    bound_ = out_.front().squared_distance;
  }

 private:
  /// Replaces the top of the heap, the farthest neighbor, by `neighbor`.
  void replace_farthest(const Neighbor& neighbor) {
    std::size_t hole = 0;
    while (2 * hole + 1 < count_) {
      std::size_t child = 2 * hole + 1;
      if (child + 1 < count_ && out_[child].squared_distance < out_[child + 1].squared_distance)
        ++child;
      if (out_[child].squared_distance <= neighbor.squared_distance) break;
      out_[hole] = out_[child];
      hole = child;
    }
    out_[hole] = neighbor;
  }

  std::span<Neighbor> out_;
  std::size_t count_ = 0;
  float bound_;
};

}  // namespace

std::size_t VoxelHashMap::nearest(const Eigen::Vector3f& query, float radius,
                                  std::span<Neighbor> out) const {
  if (!query.allFinite() || out.empty()) return 0;
  const Voxel voxel = cell_of(query);
  const VoxelKey key = voxel_key(voxel);
  const bool wide = options_.rounding == VoxelRounding::kTruncate;
  const Eigen::Array3i index = voxel.array();
  // Distances (m) from the query to the faces of its cell; each further cell adds a voxel size.
  const Eigen::Array3i lower = wide ? Eigen::Array3i(index - (index <= 0).cast<int>()) : index;
  const Eigen::Array3i upper = wide ? Eigen::Array3i(index + (index >= 0).cast<int>()) : index + 1;
  const Eigen::Array3f below = query.array() - lower.cast<float>() * size_m_;
  const Eigen::Array3f above = upper.cast<float>() * size_m_ - query.array();
  const auto gap = [&](int axis, int step) {
    if (step == 0) return 0.0F;
    const float face = step < 0 ? below[axis] : above[axis];
    const float distance = face + static_cast<float>(std::abs(step) - 1) * size_m_;
    return distance * distance;
  };
  NearestFew few(out, radius);
  const auto look_into = [&](const Step& step) {
    if (gap(0, step.dx) + gap(1, step.dy) + gap(2, step.dz) >= few.bound()) return;
    const auto found = cells_.find(key + voxel_key_step(step.dx, step.dy, step.dz));
    if (found == cells_.end()) return;
    const Cell& cell = found->second;
    for (std::size_t i = 0; i < cell.count; ++i)
      few.offer(cell.points[i], (cell.points[i] - query).squaredNorm());
  };
  for (const Step& step : kSteps) look_into(step);
  const int rings = static_cast<int>(std::ceil(radius * inverse_size_));
  for (int dz = -rings; rings > 1 && dz <= rings; ++dz) {
    for (int dy = -rings; dy <= rings; ++dy) {
      for (int dx = -rings; dx <= rings; ++dx) {
        if (std::max({std::abs(dx), std::abs(dy), std::abs(dz)}) > 1) look_into({dx, dy, dz});
      }
    }
  }
  return few.count();
}

std::vector<Eigen::Vector3f> VoxelHashMap::points() const {
  std::vector<Eigen::Vector3f> all;
  all.reserve(size_);
  for (const auto& [key, cell] : cells_)
    all.insert(all.end(), cell.points, cell.points + cell.count);
  return all;
}

std::size_t VoxelHashMap::memory_bytes() const {
  // robin_map: one array of buckets, each the value plus 8 bytes of bookkeeping
  constexpr std::size_t kBucketBytes = sizeof(std::pair<VoxelKey, Cell>) + 8;
  return cells_.bucket_count() * kBucketBytes + blocks_.memory_bytes();
}

}  // namespace lidarena::map
