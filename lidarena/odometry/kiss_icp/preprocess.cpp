// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/odometry/kiss_icp/preprocess.hpp"

#include <bit>
#include <cstdint>
#include <utility>

#include "lidarena/map/voxel_filter.hpp"

namespace lidarena::odometry::kiss_icp {

namespace {

constexpr std::uint32_t kFree = 0xFFFFFFFFU;

/// A point in a hash table.
struct Placed {
  std::uint32_t index = kFree;
  std::uint32_t wanted_slot = 0;
};

/// Robin Hood hashing (Celis, Larson, Munro, FOCS 1985): from its wanted slot on, a point takes the
/// first slot that is free or whose point is nearer to its own wanted slot; that one moves on.
void place(Placed moving, std::vector<Placed>& table) {
  const auto mask = static_cast<std::uint32_t>(table.size() - 1);
  std::uint32_t slot = moving.wanted_slot;
  const auto distance = [&](const Placed& placed) { return (slot - placed.wanted_slot) & mask; };
  for (; table[slot].index != kFree; slot = (slot + 1) & mask) {
    if (distance(moving) > distance(table[slot])) std::swap(moving, table[slot]);
  }
  table[slot] = moving;
}

}  // namespace

se3::Vector6 twist_within(const estimation::ScanTimes& times, const Pose& motion) {
  if (!times.timed) return se3::Vector6::Zero();
  return se3::log(motion) / times.seconds();
}

Points in_range(const Points& points, const Config& config) {
  Points kept;
  kept.reserve(points.size());
  for (const Eigen::Vector3f& point : points) {
    const double range = point.cast<double>().norm();
    if (config.min_range_m < range && range < config.max_range_m) kept.push_back(point);
  }
  return kept;
}

Points thin(const Points& points, double voxel_size, Release release) {
  const map::VoxelRounding rounding = cell_rounding(release);
  const auto inverse_size = static_cast<float>(1.0 / voxel_size);
  const std::uint32_t y_factor = hash_factor_y(release);
  // The hash of Teschner, Heidelberger, Mueller, Pomerantes, Gross, "Optimized spatial hashing"
  // (VMV 2003), in a table of a power of two of slots, at least two per point.
  const auto mask = static_cast<std::uint32_t>(std::bit_ceil(2 * points.size()) - 1);
  const auto wanted_slot = [&](std::uint32_t i) {
    const Eigen::Array<std::uint32_t, 3, 1> voxel =
        map::voxel_of(points[i], inverse_size, rounding).cast<std::uint32_t>();
    return (voxel.x() * 73856093U ^ voxel.y() * y_factor ^ voxel.z() * 83492791U) & mask;
  };
  const auto kept = map::first_of_each_voxel(points, voxel_size, rounding);
  std::vector<Placed> table(std::size_t{mask} + 1);
  for (const std::uint32_t i : kept) place({i, wanted_slot(i)}, table);
  Points thinned;
  thinned.reserve(kept.size());
  for (const Placed& placed : table) {
    if (placed.index != kFree) thinned.push_back(points[placed.index]);
  }
  return thinned;
}

}  // namespace lidarena::odometry::kiss_icp
