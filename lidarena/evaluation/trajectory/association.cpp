// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/evaluation/trajectory/association.hpp"

#include <algorithm>

namespace lidarena::evaluation {
namespace {

double rate_hz(const Trajectory& trajectory) {
  const Time period = median_period(trajectory);
  return period > Time{0} ? 1.0 / to_seconds(period) : 0.0;
}

/// Part of the truth's time span that lies between consecutive estimates without a gap, s.
double covered_s(const Trajectory& estimate, const Trajectory& truth) {
  const Time gap_limit = gap_limit_of(estimate);
  Time covered{0};
  const auto poses = estimate.poses();
  for (std::size_t i = 1; i < poses.size(); ++i) {
    if (poses[i].stamp - poses[i - 1].stamp > gap_limit) continue;
    const Time from = std::max(poses[i - 1].stamp, truth.begin_time());
    const Time to = std::min(poses[i].stamp, truth.end_time());
    covered += std::max(Time{0}, to - from);
  }
  return to_seconds(covered);
}

}  // namespace

Time median_period(const Trajectory& trajectory) {
  const auto poses = trajectory.poses();
  if (poses.size() < 2) return Time{0};
  std::vector<Time> periods;
  periods.reserve(poses.size() - 1);
  for (std::size_t i = 1; i < poses.size(); ++i) {
    periods.push_back(poses[i].stamp - poses[i - 1].stamp);
  }
  const auto middle = periods.begin() + static_cast<std::ptrdiff_t>(periods.size() / 2);
  std::nth_element(periods.begin(), middle, periods.end());
  return *middle;
}

Time gap_limit_of(const Trajectory& trajectory) { return median_period(trajectory) * 3 / 2; }

std::optional<Pose> pose_between(const Trajectory& trajectory, Time t, Time gap_limit) {
  const std::size_t next = trajectory.upper_bound(t);
  const auto poses = trajectory.poses();
  if (next == 0) return std::nullopt;
  if (poses[next - 1].stamp == t) return poses[next - 1].world_from_body;
  if (next == poses.size() || poses[next].stamp - poses[next - 1].stamp > gap_limit) {
    return std::nullopt;
  }
  return trajectory.at(t);
}

std::vector<PosePair> matched_poses(const Trajectory& estimate, const Trajectory& truth) {
  const Time gap_limit = gap_limit_of(truth);
  std::vector<PosePair> pairs;
  for (const StampedPose& pose : estimate.poses()) {
    const std::optional<Pose> true_pose = pose_between(truth, pose.stamp, gap_limit);
    if (true_pose) pairs.push_back({pose.stamp, *true_pose, pose.world_from_body});
  }
  return pairs;
}

Trajectory truth_at_estimates(const Trajectory& estimate, const Trajectory& truth) {
  std::vector<StampedPose> poses;
  for (const PosePair& pair : matched_poses(estimate, truth))
    poses.push_back({pair.stamp, pair.truth});
  return Trajectory(std::move(poses), "truth at the estimates");
}

bool is_coarser(const Trajectory& truth, const Trajectory& estimate) {
  constexpr double kFactor = 1.1;  // of periods; stamps jitter
  const Time period = median_period(estimate);
  return period > Time{0} && to_seconds(median_period(truth)) > kFactor * to_seconds(period);
}

Trajectory at_truth_stamps(const Trajectory& estimate, const Trajectory& truth) {
  const Time gap_limit = gap_limit_of(estimate);
  std::vector<StampedPose> poses;
  for (const StampedPose& pose : truth.poses()) {
    const std::optional<Pose> estimated = pose_between(estimate, pose.stamp, gap_limit);
    if (estimated) poses.push_back({pose.stamp, *estimated});
  }
  return Trajectory(std::move(poses), "estimate at the truth's stamps");
}

Association associate(const Trajectory& estimate, const Trajectory& truth) {
  Association found;
  found.estimates = estimate.size();
  found.truths = truth.size();
  found.estimate_rate_hz = rate_hz(estimate);
  found.truth_rate_hz = rate_hz(truth);
  const auto poses = estimate.poses();
  for (std::size_t i = 1; i < poses.size(); ++i) {
    const double gap_s = to_seconds(poses[i].stamp - poses[i - 1].stamp);
    found.longest_gap_s = std::max(found.longest_gap_s, gap_s);
  }
  if (estimate.empty() || truth.empty()) return found;
  found.matched = matched_poses(estimate, truth).size();
  const Time overlap = std::min(estimate.end_time(), truth.end_time()) -
                       std::max(estimate.begin_time(), truth.begin_time());
  found.overlap_s = std::max(0.0, to_seconds(overlap));
  const double truth_s = to_seconds(truth.end_time() - truth.begin_time());
  if (truth_s > 0.0) found.coverage = covered_s(estimate, truth) / truth_s;
  return found;
}

}  // namespace lidarena::evaluation
