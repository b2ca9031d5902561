// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/odometry/arena_lo/registration.hpp"

#include <Eigen/Eigenvalues>
#include <array>
#include <cmath>
#include <optional>
#include <vector>

#include "lidarena/odometry/arena_lo/neighborhood.hpp"

namespace lidarena::odometry::arena_lo {

namespace {

constexpr std::size_t kMaxNeighbors = 64;
constexpr std::size_t kGrain = 64;  // keypoints per task: about 0.2 ms of work

/// A keypoint's neighborhood and its position (m, world) when it was searched.
struct Found {
  std::optional<Neighborhood> neighborhood;
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
    const auto most = static_cast<std::size_t>(config_.max_residuals);
    for (const auto& candidate : candidates_) {
      if (most > 0 && matches_.size() == most) break;
      if (candidate) matches_.push_back(*candidate);
    }
    return matches_;
  }

 private:
  std::optional<estimation::ElasticMatch> match_one(const TimedPoint& keypoint,
                                                    const estimation::ElasticTrack& track,
                                                    Found& found) const {
    const Eigen::Vector3d point = keypoint.position.cast<double>();
    const Eigen::Vector3d position = track.place(point, keypoint.alpha);
    if (!((position - found.searched_at).norm() < config_.reassociation_distance_m)) {
      found = {search(position.cast<float>()), position};
    }
    if (!found.neighborhood) return std::nullopt;
    const Neighborhood& near = *found.neighborhood;
    const double distance = near.normal.dot(position - near.anchor);
    if (config_.gate_distances && std::abs(distance) >= config_.max_plane_distance_m)
      return std::nullopt;
    estimation::ElasticMatch match = config_.solver == Solver::kCeresShapes
                                         ? shape_match(near)
                                         : plane_match(near, position, config_);
    match.point = point;
    match.alpha = keypoint.alpha;
    return match;
  }

  std::optional<Neighborhood> search(const Eigen::Vector3f& position) const {
    std::array<map::Neighbor, kMaxNeighbors> room;
    const std::span near(room.data(), static_cast<std::size_t>(config_.max_neighbors));
    const auto radius = static_cast<float>(config_.search_radius_m);
    const std::size_t count = map_.nearest(position, radius, near);
    if (count < static_cast<std::size_t>(config_.min_neighbors)) return std::nullopt;
    return describe(near.first(count), config_.plane_point);
  }

  std::span<const TimedPoint> keypoints_;
  const map::VoxelHashMap& map_;
  const RegistrationConfig& config_;
  std::vector<Found> found_;
  std::vector<std::optional<estimation::ElasticMatch>> candidates_;
  std::vector<estimation::ElasticMatch> matches_;
};

estimation::ElasticMotion aligned(const estimation::ElasticProblem& problem,
                                  const estimation::ElasticMotion& motion,
                                  const RegistrationConfig& config, const Parallel& parallel) {
  return config.solver == Solver::kGaussNewton
             ? estimation::align_by_gauss_newton(problem, motion, config.inner_iterations, parallel)
             : estimation::align_by_ceres(problem, motion, config.inner_iterations);
}

double observability_of(std::span<const estimation::ElasticMatch> matches) {
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  for (const estimation::ElasticMatch& match : matches)
    sum += match.shape.topRows(match.rows).transpose() * match.shape.topRows(match.rows);
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
  solver.computeDirect(sum / sum.trace(), Eigen::EigenvaluesOnly);
  return solver.eigenvalues()[0];
}

}  // namespace

double Registration::matched_share() const {
  return keypoints == 0 ? 0.0 : static_cast<double>(matches) / static_cast<double>(keypoints);
}

Registration register_keypoints(std::span<const TimedPoint> keypoints, const map::VoxelHashMap& map,
                                const estimation::ElasticMotion& guess,
                                const estimation::MotionPrior& prior,
                                const RegistrationConfig& config, int iterations,
                                const Parallel& parallel) {
  Registration result{guess};
  result.keypoints = keypoints.size();
  Matcher matcher(keypoints, map, config);
  while (result.iterations < iterations) {
    const auto matches = matcher.match(result.motion, parallel);
    result.matches = matches.size();
    result.enough = matches.size() >= static_cast<std::size_t>(config.min_residuals);
    if (!result.enough) return result;
    result.observability = observability_of(matches);
    const estimation::ElasticMotion before = result.motion;
    result.motion = aligned(
        {matches, prior, config.robust_kernel, config.robust_kernel_scale_m, config.exact_slerp},
        before, config, parallel);
    ++result.iterations;
    const estimation::MotionChange change = estimation::change_between(before, result.motion);
    if (change.translation_m < config.convergence_translation_m &&
        change.rotation_rad < config.convergence_rotation_rad)
      break;
  }
  return result;
}

}  // namespace lidarena::odometry::arena_lo
