// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/odometry/kiss_icp/preprocess.hpp"

#include <algorithm>
#include <bit>
#include <utility>

#include "lidarena/map/voxel_filter.hpp"

namespace lidarena::odometry::kiss_icp {

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
  // The hash of Teschner, Heidelberger, Mueller, Pomerantes, Gross, "Optimized spatial hashing"
  // (VMV 2003), in a table of a power of two of slots, at least two per point. Of points in the
  // same slot, later ones follow.
  const auto mask = static_cast<std::uint32_t>(std::bit_ceil(2 * points.size()) - 1);
  const std::uint32_t y_factor = hash_factor_y(release);
  const auto slot_of = [&](const Eigen::Vector3f& point) {
    const Eigen::Array<std::uint32_t, 3, 1> voxel =
        map::voxel_of(point, inverse_size, rounding).cast<std::uint32_t>();
    return (voxel.x() * 73856093U ^ voxel.y() * y_factor ^ voxel.z() * 83492791U) & mask;
  };
  std::vector<std::pair<std::uint32_t, std::uint32_t>> slots_and_indices;
  for (const std::uint32_t i : map::first_of_each_voxel(points, voxel_size, rounding))
    slots_and_indices.emplace_back(slot_of(points[i]), i);
  std::sort(slots_and_indices.begin(), slots_and_indices.end());
  Points thinned;
  thinned.reserve(slots_and_indices.size());
  for (const auto& [slot, i] : slots_and_indices) thinned.push_back(points[i]);
  return thinned;
}

}  // namespace lidarena::odometry::kiss_icp
