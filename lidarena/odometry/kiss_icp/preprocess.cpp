// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/odometry/kiss_icp/preprocess.hpp"

#include <bit>

#include "lidarena/map/hash_order.hpp"
#include "lidarena/map/random_thinning.hpp"
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
  const auto first = map::first_of_each_voxel(points, voxel_size, rounding);
  const Points kept = map::selected<Eigen::Vector3f>(points, first);
  std::vector<std::uint32_t> hashes;
  for (const Eigen::Vector3f& point : kept)
    hashes.push_back(
        map::spatial_hash(map::voxel_of(point, inverse_size, rounding), hash_factor_y(release)));
  const std::size_t slots = std::bit_ceil(2 * points.size());  // at least two per point
  return map::selected<Eigen::Vector3f>(kept, map::robin_hood_order(hashes, slots));
}

}  // namespace lidarena::odometry::kiss_icp
