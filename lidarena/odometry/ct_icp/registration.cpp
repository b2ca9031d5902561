// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/odometry/ct_icp/registration.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <vector>

namespace lidarena::odometry::ct_icp {

namespace {

constexpr std::size_t kMaxNeighbors = 64;  // upper limit of the key max_neighbors
constexpr std::size_t kGrain = 64;         // keypoints per task: about 0.2 ms of work

std::optional<ElasticMatch> match_of(const TimedPoint& keypoint, const Eigen::Vector3d& position,
                                     const map::VoxelHashMap& map,
                                     const RegistrationConfig& config) {
  std::array<map::Neighbor, kMaxNeighbors> room;
  const std::span near(room.data(), static_cast<std::size_t>(config.max_neighbors));
  const std::size_t count =
      map.nearest(position.cast<float>(), static_cast<float>(config.search_radius_m), near);
  if (count < static_cast<std::size_t>(config.min_neighbors)) return std::nullopt;
  return plane_match(keypoint, position, near.first(count), config);
}

std::vector<ElasticMatch> matches_of(std::span<const TimedPoint> keypoints,
                                     const ElasticMotion& motion, const map::VoxelHashMap& map,
                                     const RegistrationConfig& config, const Parallel& parallel) {
  const ElasticTrack track(motion);
  std::vector<std::optional<ElasticMatch>> found(keypoints.size());
  parallel.for_each(keypoints.size(), kGrain, [&](std::size_t i) {
    const TimedPoint& keypoint = keypoints[i];
    const auto position = track.place(keypoint.position.cast<double>(), keypoint.alpha);
    found[i] = match_of(keypoint, position, map, config);
  });
  std::vector<ElasticMatch> matches;
  matches.reserve(found.size());
  for (const auto& match : found) {
    if (match) matches.push_back(*match);
  }
  return matches;
}

}  // namespace

ElasticMatch plane_match(const TimedPoint& keypoint, const Eigen::Vector3d& position,
                         std::span<const map::Neighbor> neighbors,
                         const RegistrationConfig& config) {
  const map::Neighborhood plane = map::describe(neighbors);
  const auto farthest = std::max_element(
      neighbors.begin(), neighbors.end(),
      [](const auto& a, const auto& b) { return a.squared_distance < b.squared_distance; });
  ElasticMatch match;
  match.point = keypoint.position.cast<double>();
  match.alpha = keypoint.alpha;
  match.anchor = farthest->point.cast<double>();
  match.normal = plane.normal;
  const double reach = config.max_plane_distance_m * config.min_neighbors;
  const double nearness = std::exp(-(match.anchor - position).norm() / reach);
  match.weight = (config.planarity_weight * plane.planarity * plane.planarity +
                  config.proximity_weight * nearness) /
                 (config.planarity_weight + config.proximity_weight);
  return match;
}

Registration register_keypoints(std::span<const TimedPoint> keypoints, const map::VoxelHashMap& map,
                                const Expectation& expected, const RegistrationConfig& config,
                                const Parallel& parallel) {
  Registration result{expected.guess};
  while (result.iterations < config.max_iterations) {
    const auto matches = matches_of(keypoints, result.motion, map, config, parallel);
    result.matches = matches.size();
    result.failed = matches.size() < static_cast<std::size_t>(config.min_neighbors);
    if (result.failed) return result;
    result.observability = observability_of(matches);
    const ElasticMotion before = result.motion;
    result.motion = align({matches, expected.prior, config.robust_kernel_scale_m}, before,
                          config.inner_iterations, parallel);
    ++result.iterations;
    const MotionChange change = change_between(before, result.motion);
    if (change.translation_m < config.convergence_translation_m &&
        change.rotation_rad < config.convergence_rotation_rad)
      break;
  }
  return result;
}

}  // namespace lidarena::odometry::ct_icp
