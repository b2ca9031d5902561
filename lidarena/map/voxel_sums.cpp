// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/map/voxel_sums.hpp"

#include <cmath>

#include "lidarena/base/error.hpp"

namespace lidarena::map {
namespace {

constexpr double kMicrometers = 1e6;  // in a meter

Eigen::Matrix<std::int64_t, 3, 1> in_micrometers(const Eigen::Vector3f& point) {
  const auto rounded = [](float x) {
    return static_cast<std::int64_t>(std::llround(kMicrometers * double{x}));
  };
  return {rounded(point.x()), rounded(point.y()), rounded(point.z())};
}

}  // namespace

VoxelSums::VoxelSums(double voxel_size) : cells_per_meter_(static_cast<float>(1.0 / voxel_size)) {
  if (!(voxel_size > 0.0)) throw InputError("voxel_size", "must be above 0 m");
}

VoxelKey VoxelSums::key_of(const Eigen::Vector3f& point) const {
  return voxel_key(voxel_of(cells_per_meter_ * point, 1.0F));
}

void VoxelSums::add(std::span<const Eigen::Vector3f> points) {
  for (const Eigen::Vector3f& point : points) {
    if (!point.allFinite()) continue;
    const auto [place, is_new] =
        places_.try_emplace(key_of(point), static_cast<std::uint32_t>(cells_.size()));
    if (is_new) cells_.push_back({place->first});
    Cell& cell = cells_[place->second];
    cell.sum_um += in_micrometers(point);
    ++cell.count;
  }
}

void VoxelSums::remove(std::span<const Eigen::Vector3f> points) {
  for (const Eigen::Vector3f& point : points) {
    if (!point.allFinite()) continue;
    const auto place = places_.find(key_of(point));
    if (place == places_.end()) continue;
    Cell& cell = cells_[place->second];
    cell.sum_um -= in_micrometers(point);
    if (--cell.count > 0) continue;
    const std::uint32_t freed = place->second;  // the last cell moves there
    places_.erase(place);
    if (freed + 1 < cells_.size()) {
      cells_[freed] = cells_.back();
      places_[cells_[freed].key] = freed;
    }
    cells_.pop_back();
  }
}

void VoxelSums::clear() {
  cells_.clear();
  places_.clear();
}

std::vector<Eigen::Vector3f> VoxelSums::means() const {
  std::vector<Eigen::Vector3f> means;
  means.reserve(cells_.size());
  for (const Cell& cell : cells_) {
    const double unit = 1.0 / (kMicrometers * static_cast<double>(cell.count));
    means.emplace_back((cell.sum_um.cast<double>() * unit).cast<float>());
  }
  return means;
}

std::uint64_t VoxelSums::memory_bytes() const {
  return cells_.capacity() * sizeof(Cell) +
         places_.bucket_count() * sizeof(std::pair<std::uint64_t, std::uint64_t>);
}

}  // namespace lidarena::map
