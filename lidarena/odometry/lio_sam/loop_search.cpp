// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/odometry/lio_sam/loop_search.hpp"

#include <algorithm>
#include <array>
#include <limits>

#include "lidarena/base/so3.hpp"
#include "lidarena/estimation/least_squares.hpp"
#include "lidarena/map/voxel_filter.hpp"

namespace lidarena::odometry::lio_sam {
namespace {

using Covariance = estimation::PoseGraph::Covariance;
using Equations =
    estimation::NormalEquations<6>;  // rotation about the target's origin, translation
using Points = std::vector<Eigen::Vector3f>;

constexpr std::size_t kMinSourcePoints = 300;
constexpr std::size_t kMinTargetPoints = 1000;
constexpr std::size_t kMinCorrespondences = 10;
constexpr int kMaxIterations = 100;
constexpr double kSmallStep = 3e-4;            // m, rad: ICP has converged
constexpr double kReachPerRadius = 2.0;        // reach of ICP / search radius
constexpr double kOdometryRotation = 1e-6;     // rad^2, variance from keyframe to keyframe
constexpr double kOdometryTranslation = 1e-4;  // m^2
constexpr double kStartVariance = 1e-8;        // of the first pose, which stays
constexpr double kMinVariance = 1e-6;          // of a loop

Covariance covariance(double translation, double rotation) {
  Eigen::Matrix<double, 6, 1> variances;
  variances << Eigen::Vector3d::Constant(translation), Eigen::Vector3d::Constant(rotation);
  return variances.asDiagonal();
}

/// Voxel means of the keyframes [begin, end), in the frame of one of them.
Points cloud_of(const std::vector<Keyframe>& keyframes, std::size_t begin, std::size_t end,
                const Pose& frame_from_world, double voxel_size) {
  Points points;
  for (std::size_t i = begin; i < end; ++i) {
    const Pose frame_from_lidar = frame_from_world * keyframes[i].world_from_lidar;
    map::append_placed(frame_from_lidar, keyframes[i].features.edges, points);
    map::append_placed(frame_from_lidar, keyframes[i].features.surfaces, points);
  }
  return map::voxel_means(points, voxel_size);
}

/// The nearest point of `target`, if there is one within `reach` (m).
std::optional<map::Neighbor> nearest(const map::KdTree& target, const Eigen::Vector3d& point,
                                     double reach) {
  std::array<map::Neighbor, 1> near;
  if (target.nearest(point.cast<float>(), near, static_cast<float>(reach)) == 0)
    return std::nullopt;
  return near[0];
}

double fitness_of(const Points& source, const map::KdTree& target, const Pose& pose, double reach) {
  double squares = 0.0;
  double count = 0.0;
  for (const Eigen::Vector3f& point : source) {
    if (const auto near = nearest(target, pose * point.cast<double>(), reach)) {
      squares += double{near->squared_distance};
      count += 1.0;
    }
  }
  return count > 0.0 ? squares / count : std::numeric_limits<double>::infinity();
}

}  // namespace

std::optional<std::size_t> find_candidate(const std::vector<Keyframe>& keyframes,
                                          const LoopRule& rule) {
  const Keyframe& last = keyframes.back();
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

Alignment align_points(const Points& source, const map::KdTree& target, const Pose& guess,
                       double reach, const Parallel& parallel) {
  Alignment result{.target_from_source = guess};
  for (int iteration = 0; iteration < kMaxIterations && !result.converged; ++iteration) {
    const Pose& pose = result.target_from_source;
    const auto sum = estimation::accumulate_normal_equations<6>(
        parallel, source.size(), [&](std::size_t i, Equations& equations) {
          const Eigen::Vector3d moved = pose * source[i].cast<double>();
          const auto near = nearest(target, moved, reach);
          if (!near) return;
          Eigen::Matrix<double, 3, 6> jacobian;
          jacobian << -so3::hat(moved), Eigen::Matrix3d::Identity();
          equations.add<3>(jacobian, moved - near->point.cast<double>(), 1.0);
        });
    const Equations::Vector step = sum.solve();
    if (sum.count < kMinCorrespondences || !step.allFinite()) break;
    const Pose correction = make_pose(so3::exp(step.head<3>()), step.tail<3>());
    result.target_from_source = orthonormalized(correction * pose);
    result.converged = step.cwiseAbs().maxCoeff() < kSmallStep;
  }
  result.fitness = fitness_of(source, target, result.target_from_source, reach);
  return result;
}

bool LoopSearch::close(const std::vector<Keyframe>& keyframes, const Pose& previous_from_last) {
  add_node(previous_from_last);
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

void LoopSearch::add_node(const Pose& previous_from_last) {
  if (graph_.nodes.empty()) {
    graph_.nodes.push_back(previous_from_last);
    graph_.priors.push_back({0, previous_from_last, covariance(kStartVariance, kStartVariance)});
    return;
  }
  const std::size_t last = graph_.nodes.size();
  graph_.nodes.push_back(orthonormalized(graph_.nodes.back() * previous_from_last));
  graph_.betweens.push_back({.first = last - 1,
                             .second = last,
                             .first_from_second = previous_from_last,
                             .covariance = covariance(kOdometryTranslation, kOdometryRotation)});
}

std::optional<estimation::PoseGraph::Between> LoopSearch::verify(
    const std::vector<Keyframe>& keyframes, std::size_t candidate) const {
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
  const Alignment found = align_points(source, tree, old_from_world * world_from_last,
                                       kReachPerRadius * config_.loop.search_radius_m, parallel_);
  if (!found.converged || !(found.fitness < config_.loop.max_fitness_m2)) return std::nullopt;
  const double variance = std::max(found.fitness, kMinVariance);
  return estimation::PoseGraph::Between{.first = candidate,
                                        .second = last,
                                        .first_from_second = found.target_from_source,
                                        .covariance = covariance(variance, variance)};
}

std::uint64_t LoopSearch::memory_bytes() const {
  return graph_.nodes.capacity() * sizeof(Pose) +
         graph_.betweens.capacity() * sizeof(estimation::PoseGraph::Between);
}

}  // namespace lidarena::odometry::lio_sam
