// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/odometry/arena_lo/sampling.hpp"

#include "lidarena/map/random_thinning.hpp"

namespace lidarena::odometry::arena_lo {

std::vector<TimedPoint> thin(std::span<const TimedPoint> points, double voxel) {
  const auto inverse = static_cast<float>(1.0 / voxel);
  std::vector<map::VoxelKey> voxels;
  voxels.reserve(points.size());
  for (const TimedPoint& point : points)
    voxels.push_back(map::voxel_key(map::voxel_of(point.position, inverse)));
  return map::selected(points, map::one_per_voxel(voxels));
}

std::vector<TimedPoint> sample_keypoints(std::span<const TimedPoint> frame,
                                         const SamplingConfig& config) {
  const std::vector<TimedPoint> keypoints = thin(frame, config.keypoint_voxel_size_m);
  const auto limit = static_cast<std::size_t>(config.max_keypoints);
  return map::selected<TimedPoint>(keypoints, map::drawn(keypoints.size(), limit));
}

}  // namespace lidarena::odometry::arena_lo
