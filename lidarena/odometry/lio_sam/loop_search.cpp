// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/odometry/lio_sam/loop_search.hpp"

#include <algorithm>

#include "lidarena/loop/icp.hpp"
#include "lidarena/map/voxel_filter.hpp"

namespace lidarena::odometry::lio_sam {
namespace {

using Points = std::vector<Eigen::Vector3f>;

constexpr std::size_t kMinSourcePoints = 300;
constexpr std::size_t kMinTargetPoints = 1000;
constexpr double kReachPerRadius = 2.0;        // reach of ICP / search radius
constexpr double kOdometryRotation = 1e-6;     // rad^2, variance from keyframe to keyframe
constexpr double kOdometryTranslation = 1e-4;  // m^2
constexpr double kMinVariance = 1e-6;          // of a loop

/// Voxel means of the keyframes [begin, end), in the frame of one of them.
Points cloud_of(const std::vector<map::Keyframe>& keyframes, std::size_t begin, std::size_t end,
                const Pose& frame_from_world, double voxel_size) {
  Points points;
  for (std::size_t i = begin; i < end; ++i) {
    const Pose frame_from_lidar = frame_from_world * keyframes[i].world_from_lidar;
    map::append_placed(frame_from_lidar, keyframes[i].features.edges, points);
    map::append_placed(frame_from_lidar, keyframes[i].features.surfaces, points);
  }
  return map::voxel_means(points, voxel_size);
}

}  // namespace

std::optional<std::size_t> find_candidate(const std::vector<map::Keyframe>& keyframes,
                                          const LoopRule& rule) {
  const map::Keyframe& last = keyframes.back();
  std::optional<std::size_t> best;
  double least = rule.search_radius_m;
  for (std::size_t i = 0; i + 1 < keyframes.size(); ++i) {
    const Eigen::Vector3d place = keyframes[i].world_from_lidar.translation();
    const double distance = (place - last.world_from_lidar.translation()).norm();
    const bool old = to_seconds(last.stamp - keyframes[i].stamp) > rule.min_time_gap_s;
    if (!old || distance >= least) continue;
    least = distance;
    best = i;
  }
  return best;
}

bool LoopSearch::close(const std::vector<map::Keyframe>& keyframes,
                       const Pose& previous_from_last) {
  const auto odometry = estimation::diagonal_covariance(kOdometryTranslation, kOdometryRotation);
  estimation::append_to_chain(previous_from_last, odometry, graph_);
  const Time now = keyframes.back().stamp;
  if (!config_.loop_closure ||
      (last_search_ && to_seconds(now - *last_search_) < config_.loop.interval_s))
    return false;
  last_search_ = now;
  const std::optional<std::size_t> candidate = find_candidate(keyframes, config_.loop);
  if (!candidate) return false;
  ++tried_;
  const auto loop = verify(keyframes, *candidate);
  if (!loop) return false;
  ++accepted_;
  graph_.betweens.push_back(*loop);
  graph_.nodes = estimation::optimize(graph_).nodes;
  return true;
}

std::optional<estimation::PoseGraph::Between> LoopSearch::verify(
    const std::vector<map::Keyframe>& keyframes, std::size_t candidate) const {
  const std::size_t last = keyframes.size() - 1;
  const auto around = static_cast<std::size_t>(config_.loop.target_keyframes);
  const Pose old_from_world = keyframes[candidate].world_from_lidar.inverse();
  const Pose& world_from_last = keyframes[last].world_from_lidar;
  const double voxel_size = config_.surface_voxel_size_m;
  const Points source = cloud_of(keyframes, last, last + 1, world_from_last.inverse(), voxel_size);
  Points target =
      cloud_of(keyframes, candidate - std::min(candidate, around),
               std::min(candidate + around + 1, keyframes.size()), old_from_world, voxel_size);
  if (source.size() < kMinSourcePoints || target.size() < kMinTargetPoints) return std::nullopt;
  map::KdTree tree;
  tree.build(std::move(target));
  const loop::PointAlignment found =
      loop::align_points(source, tree, old_from_world * world_from_last,
                         kReachPerRadius * config_.loop.search_radius_m, parallel_);
  if (!found.converged || !(found.fitness < config_.loop.max_fitness_m2)) return std::nullopt;
  const double variance = std::max(found.fitness, kMinVariance);
  return estimation::PoseGraph::Between{
      .first = candidate,
      .second = last,
      .first_from_second = found.target_from_source,
      .covariance = estimation::diagonal_covariance(variance, variance)};
}

}  // namespace lidarena::odometry::lio_sam
