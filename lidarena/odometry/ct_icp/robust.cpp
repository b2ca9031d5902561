// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/odometry/ct_icp/robust.hpp"

#include <algorithm>

#include "lidarena/base/angle.hpp"
#include "lidarena/base/so3.hpp"

namespace lidarena::odometry::ct_icp {

namespace {

// Of the published program, which has no options for them.
constexpr double kMaxTrustedTranslation = 1.0;  // m, from begin to end
constexpr int kMoreSteps = 30;
constexpr int kMoreIterations = 20;
constexpr int kMostIterations = 50;
constexpr double kFinerKeypoints = 1.5;
constexpr double kFinerConvergence = 10.0;
constexpr double kFinestRotation_deg = 1e-5;
constexpr double kFinestTranslation = 1e-4;  // m
constexpr double kWiderKernel = 1.2;
constexpr double kWiderPlanes = 1.5;

}  // namespace

Settings more_careful(Settings settings, const SamplingConfig& sampling) {
  RegistrationConfig& r = settings.registration;
  r.inner_iterations += kMoreSteps;
  r.max_iterations = std::min(r.max_iterations + kMoreIterations, kMostIterations);
  const double rotation_deg = std::max(
      r.convergence_rotation_rad * kDegreesPerRadian / kFinerConvergence, kFinestRotation_deg);
  r.convergence_rotation_rad = rotation_deg * kDegree;
  // the program takes the limit of the rotation, in degrees, for that of the translation
  r.convergence_translation_m = std::max(rotation_deg / kFinerConvergence, kFinestTranslation);
  r.robust_kernel_scale_m *= kWiderKernel;
  r.max_plane_distance_m *= kWiderPlanes;
  const double finest = std::min(sampling.initial_scan_voxel_size_m, sampling.scan_voxel_size_m);
  settings.sampling.keypoint_voxel_size_m =
      std::max(sampling.keypoint_voxel_size_m / kFinerKeypoints, finest);
  settings.sampling.initial_keypoint_voxel_size_m = settings.sampling.keypoint_voxel_size_m;
  return settings;
}

bool RobustRegistration::turns(const ElasticMotion& motion, const Pose& last_end) const {
  return rotation_between(motion.begin, motion.end) > config_.max_scan_rotation_deg * kDegree ||
         rotation_between(last_end, motion.end) > config_.max_rotation_deg * kDegree;
}

bool RobustRegistration::trusts(const ElasticMotion& motion, const Pose& last_end,
                                const RegistrationConfig& limits) const {
  return is_plausible(motion, last_end, limits) && !turns(motion, last_end) &&
         (motion.end.translation() - motion.begin.translation()).norm() <= kMaxTrustedTranslation;
}

bool RobustRegistration::admits(const ElasticMotion& motion, const Pose& last_end, int attempts) {
  const bool turning = turns(motion, last_end);
  level_ = config_.minimal_level + (turning || attempts > 1 ? 1 : 0);
  return !turning;
}

}  // namespace lidarena::odometry::ct_icp
