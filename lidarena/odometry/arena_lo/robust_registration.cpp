// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/odometry/arena_lo/robust_registration.hpp"

#include <algorithm>

#include "lidarena/base/so3.hpp"

namespace lidarena::odometry::arena_lo {

namespace {

double rotation_within(const estimation::ElasticMotion& motion) {
  return so3::angle(motion.begin().linear().transpose() * motion.end().linear());
}

}  // namespace

Config at_level(Config config, int level) {
  SamplingConfig& sampling = config.sampling;
  RegistrationConfig& registration = config.registration;
  for (int i = 0; i < level; ++i) {
    sampling.keypoint_voxel_size_m /= 1.5;
    sampling.initial_keypoint_voxel_size_m /= 1.5;
    sampling.max_keypoints *= 2;
    registration.max_residuals *= 2;
    registration.max_iterations += 20;
    registration.inner_iterations += 30;
    registration.convergence_translation_m /= 10.0;
    registration.convergence_rotation_rad /= 10.0;
    registration.robust_kernel_scale_m *= 1.2;
    registration.max_plane_distance_m *= 1.5;
  }
  return config;
}

Verdict verdict_on(const Registration& registration, const estimation::ElasticMotion& guess,
                   const RobustConfig& config) {
  const estimation::ElasticMotion& motion = registration.motion;
  if (!registration.enough || !motion.begin().matrix().allFinite() ||
      !motion.end().matrix().allFinite())
    return Verdict::kLost;
  const double turned = rotation_within(motion);
  const double moved = (motion.end().translation() - guess.begin().translation()).norm();
  if (moved > config.lost_translation_m || turned > config.lost_rotation_rad) return Verdict::kLost;
  const bool trusted =
      turned < config.max_rotation_rad && registration.matched_share() >= config.min_matched_share;
  return trusted ? Verdict::kTrusted : Verdict::kSuspect;
}

RobustRegistration register_robustly(std::span<const TimedPoint> frame,
                                     const map::VoxelHashMap& map,
                                     const estimation::ElasticMotion& guess,
                                     const estimation::MotionPrior& prior, const Config& config,
                                     bool starting, int first_level, const Parallel& parallel) {
  RobustRegistration result;
  const int attempts = config.robust.enabled ? config.robust.max_attempts : 1;
  for (int attempt = 0; attempt < attempts; ++attempt) {
    result.level = first_level + attempt;
    const Config settings = at_level(config, result.level);
    const SamplingConfig& sampling = settings.sampling;
    const RegistrationConfig& registration = settings.registration;
    const double voxel =
        starting ? sampling.initial_keypoint_voxel_size_m : sampling.keypoint_voxel_size_m;
    const auto keypoints =
        sample_keypoints(frame, sampling.keypoints, voxel, starting ? 0 : sampling.max_keypoints,
                         config.voxel_rounding);
    const int iterations =
        starting ? std::max(registration.initial_iterations, registration.max_iterations)
                 : registration.max_iterations;
    result.registration =
        register_keypoints(keypoints, map, guess, prior, registration, iterations, parallel);
    result.verdict = verdict_on(result.registration, guess, config.robust);
    if (result.verdict == Verdict::kTrusted) break;
  }
  return result;
}

bool InsertionGate::admits(const estimation::ElasticMotion& motion, Verdict verdict) {
  const bool suspect = (config_.rule == Insertion::kSmallRotation &&
                        rotation_within(motion) > config_.max_rotation_rad) ||
                       (config_.rule == Insertion::kTrusted && verdict != Verdict::kTrusted);
  if (suspect && skipped_ <= config_.max_skipped) {
    ++skipped_;
    return false;
  }
  skipped_ = 0;
  return true;
}

}  // namespace lidarena::odometry::arena_lo
