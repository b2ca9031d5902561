// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/odometry/ct_icp/sampling.hpp"

#include <algorithm>
#include <array>

#include "lidarena/map/random_thinning.hpp"

namespace lidarena::odometry::ct_icp {

namespace {

/// Cells of the adaptive grid: `edge` m for points nearer than `range` m; values of the published
/// program.
struct Ring {
  float range;
  double edge;
};
constexpr float kNearest = 0.5F;  // m; nearer points are no keypoints
constexpr std::array kRings{Ring{2.0F, 0.1}, Ring{4.0F, 0.2}, Ring{8.0F, 0.4}, Ring{16.0F, 0.8},
                            Ring{200.0F, 1.6}};

std::vector<TimedPoint> adaptive(std::span<const TimedPoint> frame) {
  std::array<std::vector<TimedPoint>, kRings.size()> by_ring;
  for (const TimedPoint& point : frame) {
    const float range = point.position.norm();
    if (range < kNearest) continue;
    const auto ring = std::find_if(kRings.begin(), kRings.end(),
                                   [&](const Ring& candidate) { return range < candidate.range; });
    if (ring != kRings.end())
      by_ring[static_cast<std::size_t>(ring - kRings.begin())].push_back(point);
  }
  std::vector<TimedPoint> keypoints;
  for (std::size_t i = 0; i < kRings.size(); ++i) {
    const auto part = thin(by_ring[i], kRings[i].edge);
    keypoints.insert(keypoints.end(), part.begin(), part.end());
  }
  return keypoints;
}

std::vector<TimedPoint> candidates(std::span<const TimedPoint> frame, KeypointSampling sampling,
                                   double voxel) {
  switch (sampling) {
    case KeypointSampling::kAll:
      break;
    case KeypointSampling::kGrid:
      return thin(frame, voxel);
    case KeypointSampling::kAdaptive:
      return adaptive(frame);
  }
  return {frame.begin(), frame.end()};
}

}  // namespace

std::vector<TimedPoint> thin(std::span<const TimedPoint> points, double voxel) {
  return map::selected(
      points, map::one_per_voxel(map::voxels_of(points, voxel, map::VoxelRounding::kTruncate)));
}

std::vector<TimedPoint> sample_keypoints(std::span<const TimedPoint> frame,
                                         const SamplingConfig& config, bool starting) {
  const double voxel =
      starting ? config.initial_keypoint_voxel_size_m : config.keypoint_voxel_size_m;
  const std::vector<TimedPoint> keypoints = candidates(frame, config.keypoints, voxel);
  if (starting || config.max_keypoints == 0) return keypoints;
  const auto limit = static_cast<std::size_t>(config.max_keypoints);
  return map::selected<TimedPoint>(keypoints, map::drawn(keypoints.size(), limit));
}

}  // namespace lidarena::odometry::ct_icp
