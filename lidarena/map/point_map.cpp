// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/map/point_map.hpp"

#include <utility>

#include "lidarena/base/error.hpp"

namespace lidarena::map {

PointMap::PointMap(double voxel_size, std::size_t expected)
    : inverse_size_(static_cast<float>(1.0 / voxel_size)) {
  if (!(voxel_size > 0.0)) throw InputError("voxel_size", "must be above 0 m");
  points_.reserve(expected);
}

bool PointMap::insert(const Eigen::Vector3f& point) {
  if (!point.allFinite()) return false;
  const Voxel voxel = voxel_of(point, inverse_size_);
  const Voxel block(voxel.x() >> 2, voxel.y() >> 2, voxel.z() >> 2);
  const int bit = (voxel.x() & 3) | (voxel.y() & 3) << 2 | (voxel.z() & 3) << 4;
  std::uint64_t& taken = blocks_[voxel_key(block)];
  const std::uint64_t mask = std::uint64_t{1} << static_cast<unsigned>(bit);
  if ((taken & mask) != 0) return false;
  taken |= mask;
  points_.push_back(point);
  return true;
}

void PointMap::insert(std::span<const Eigen::Vector3f> points) {
  for (const Eigen::Vector3f& point : points) insert(point);
}

std::vector<Eigen::Vector3f> PointMap::take() {
  blocks_ = {};
  return std::exchange(points_, {});
}

std::size_t PointMap::memory_bytes() const {
  // robin_map: one array of buckets, each the value plus 8 bytes of bookkeeping
  constexpr std::size_t kBucketBytes = sizeof(Blocks::value_type) + 8;
  return points_.capacity() * sizeof(Eigen::Vector3f) + blocks_.bucket_count() * kBucketBytes;
}

}  // namespace lidarena::map
