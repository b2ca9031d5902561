// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "lidarena/odometry/ct_icp/config.hpp"
#include "lidarena/odometry/ct_icp/quality.hpp"

namespace lidarena::odometry::ct_icp {

/// What one attempt at a registration uses.
struct Settings {
  SamplingConfig sampling;
  RegistrationConfig registration;
};

/// The settings of the level of care after `settings`: finer keypoints, more iterations, finer
/// limits of convergence, a wider kernel. `sampling` is the configured one.
Settings more_careful(Settings settings, const SamplingConfig& sampling);

/// Keeps account of the robust registration: at which level of care a scan begins, whether an
/// attempt is trusted, and which scans enter the map.
class RobustRegistration {
 public:
  explicit RobustRegistration(const RobustConfig& config)
      : config_(config), level_(config.minimal_level) {}

  /// The level of care of the next scan's first attempt.
  int first_level() const { return level_; }
  /// Whether the rotation within the scan or since `last_end` is large.
  bool turns(const ElasticMotion& motion, const Pose& last_end) const;
  /// Whether no further attempt is needed: the motion is plausible, at most 1 m, and does not turn.
  bool trusts(const ElasticMotion& motion, const Pose& last_end,
              const RegistrationConfig& limits) const;
  /// Stores how a scan ended; returns whether it enters the map.
  bool admits(const ElasticMotion& motion, const Pose& last_end, int attempts);

 private:
  RobustConfig config_;
  int level_;
};

}  // namespace lidarena::odometry::ct_icp
