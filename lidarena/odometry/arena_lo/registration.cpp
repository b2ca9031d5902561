// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/odometry/arena_lo/registration.hpp"

#include <array>
#include <cmath>
#include <optional>
#include <vector>

#include "lidarena/base/so3.hpp"

namespace lidarena::odometry::arena_lo {

namespace {

constexpr std::size_t kMaxNeighbors = 20;    // the nearest of them describe the map at a keypoint
constexpr double kMaxPlaneDistance = 0.3;    // m; matches beyond are dropped
constexpr double kPlanarityWeight = 0.9;     // share of the squared planarity in a match's weight
constexpr double kProximityWeight = 0.1;     // share of the plane point's proximity
constexpr std::size_t kMinMatches = 50;      // with fewer, a registration has failed
constexpr double kConverged = 1e-3;          // m, change of both ends together by an iteration
constexpr double kConvergedRotation = 2e-4;  // rad, likewise
constexpr double kLostTranslation = 5.0;     // m, from the expected begin; 180 km/h at 10 Hz
constexpr std::size_t kGrain = 64;           // keypoints per task: about 0.2 ms of work

/// A keypoint's neighborhood and its position (m, world) when it was searched.
struct Found {
  std::optional<map::Neighborhood> neighborhood;
  Eigen::Vector3d searched_at = Eigen::Vector3d::Constant(INFINITY);
};

/// Matches keypoints with the map; keeps neighborhoods from one iteration to the next.
class Matcher {
 public:
  Matcher(std::span<const TimedPoint> keypoints, const map::VoxelHashMap& map,
          const RegistrationConfig& config)
      : keypoints_(keypoints),
        map_(map),
        config_(config),
        found_(keypoints.size()),
        candidates_(keypoints.size()) {}

  std::span<const estimation::ElasticMatch> match(const estimation::ElasticMotion& motion,
                                                  const Parallel& parallel) {
    const estimation::ElasticTrack track(motion);
    parallel.for_each(keypoints_.size(), kGrain, [&](std::size_t i) {
      candidates_[i] = match_one(keypoints_[i], track, found_[i]);
    });
    matches_.clear();
    for (const auto& candidate : candidates_) {
      if (candidate) matches_.push_back(*candidate);
    }
    return matches_;
  }

 private:
  std::optional<estimation::ElasticMatch> match_one(const TimedPoint& keypoint,
                                                    const estimation::ElasticTrack& track,
                                                    Found& found) const {
    const Eigen::Vector3d position = track.place(keypoint.position.cast<double>(), keypoint.alpha);
    if (!((position - found.searched_at).norm() < config_.reassociation_distance_m)) {
      found = {search(position.cast<float>()), position};
    }
    if (!found.neighborhood) return std::nullopt;
    const map::Neighborhood& near = *found.neighborhood;
    const double distance = near.normal.dot(position - near.mean);
    if (std::abs(distance) >= kMaxPlaneDistance) return std::nullopt;
    return plane_match(keypoint, position, near, config_);
  }

  std::optional<map::Neighborhood> search(const Eigen::Vector3f& position) const {
    std::array<map::Neighbor, kMaxNeighbors> near;
    const std::size_t count =
        map_.nearest(position, static_cast<float>(config_.search_radius_m), near);
    if (count < static_cast<std::size_t>(config_.min_neighbors)) return std::nullopt;
    return map::describe(std::span(near).first(count));
  }

  std::span<const TimedPoint> keypoints_;
  const map::VoxelHashMap& map_;
  const RegistrationConfig& config_;
  std::vector<Found> found_;
  std::vector<std::optional<estimation::ElasticMatch>> candidates_;
  std::vector<estimation::ElasticMatch> matches_;
};

bool is_plausible(const estimation::ElasticMotion& motion, const Pose& expected_begin,
                  double max_rotation) {
  if (!motion.begin().matrix().allFinite() || !motion.end().matrix().allFinite()) return false;
  const double turned = so3::angle(motion.begin().linear().transpose() * motion.end().linear());
  const double moved = (motion.end().translation() - expected_begin.translation()).norm();
  return moved <= kLostTranslation && turned <= max_rotation;
}

bool has_converged(const estimation::ElasticMotion& before, const estimation::ElasticMotion& now) {
  const estimation::MotionChange change = estimation::change_between(before, now);
  return change.translation_m < kConverged && change.rotation_rad < kConvergedRotation;
}

}  // namespace

estimation::ElasticMatch plane_match(const TimedPoint& keypoint, const Eigen::Vector3d& position,
                                     const map::Neighborhood& near,
                                     const RegistrationConfig& config) {
  const double reach = kMaxPlaneDistance * config.min_neighbors;  // m, decay of the proximity
  const double proximity = std::exp(-(near.mean - position).norm() / reach);
  estimation::ElasticMatch match;
  match.point = keypoint.position.cast<double>();
  match.alpha = keypoint.alpha;
  match.anchor = near.mean;
  match.normal = near.normal;
  match.weight = kPlanarityWeight * near.planarity * near.planarity + kProximityWeight * proximity;
  return match;
}

Registration register_keypoints(std::span<const TimedPoint> keypoints, const map::VoxelHashMap& map,
                                const Expectation& expected, const RegistrationConfig& config,
                                const Parallel& parallel) {
  Registration result{expected.guess};
  Matcher matcher(keypoints, map, config);
  while (result.iterations < config.max_iterations) {
    const auto matches = matcher.match(result.motion, parallel);
    result.matches = matches.size();
    result.failed = matches.size() < kMinMatches;
    if (result.failed) break;
    result.observability = estimation::observability_of(matches);
    const estimation::ElasticMotion before = result.motion;
    result.motion = estimation::gauss_newton_step(
        {matches, expected.prior, config.robust_kernel_scale_m}, before, parallel);
    ++result.iterations;
    if (has_converged(before, result.motion)) break;
  }
  result.failed = result.failed ||
                  !is_plausible(result.motion, expected.guess.begin(), config.lost_rotation_rad);
  if (result.failed) result.motion = expected.guess;
  return result;
}

}  // namespace lidarena::odometry::arena_lo
