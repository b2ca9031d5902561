// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/odometry/arena_lo/sampling.hpp"

#include "lidarena/map/random_thinning.hpp"

namespace lidarena::odometry::arena_lo {

std::vector<TimedPoint> thin(std::span<const TimedPoint> points, double voxel) {
  return map::selected(points, map::one_per_voxel(map::voxels_of(points, voxel)));
}

std::vector<TimedPoint> sample_keypoints(std::span<const TimedPoint> frame,
                                         const SamplingConfig& config) {
  const std::vector<TimedPoint> keypoints = thin(frame, config.keypoint_voxel_size_m);
  const auto limit = static_cast<std::size_t>(config.max_keypoints);
  return map::selected<TimedPoint>(keypoints, map::drawn(keypoints.size(), limit));
}

}  // namespace lidarena::odometry::arena_lo
