// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>

#include "lidarena/odometry/arena_lo/registration.hpp"

namespace lidarena::odometry::arena_lo {

/// Settings of a retry level above 0. Each level changes once more: keypoint voxels divided by 1.5,
/// keypoint limits doubled, 20 more iterations and 30 more of the solver, convergence thresholds
/// divided by 10, robust kernel 1.2 and distance gate 1.5 times as wide.
Config at_level(Config config, int level);

/// Quality of a registration.
enum class Verdict {
  kTrusted,
  kSuspect,  ///< more rotation or fewer matches than RobustConfig trusts
  kLost,     ///< failed: too few matches, not finite, or motion beyond the limits of RobustConfig
};
Verdict verdict_on(const Registration& registration, const estimation::ElasticMotion& guess,
                   const RobustConfig& config);

struct RobustRegistration {
  Registration registration;
  Verdict verdict = Verdict::kTrusted;
  int level = 0;
};

/// Registers the keypoints of `frame` at `first_level`; while the result is not trusted, repeats
/// that from the same guess at the next level, up to max_attempts in total (one unless
/// `config.robust.enabled`). `starting`: the scan is one of the first initial_scans.
RobustRegistration register_robustly(std::span<const TimedPoint> frame,
                                     const map::VoxelHashMap& map,
                                     const estimation::ElasticMotion& guess,
                                     const estimation::MotionPrior& prior, const Config& config,
                                     bool starting, int first_level, const Parallel& parallel);

/// Decides which scans enter the map: suspect ones are skipped, unless too many were in a row.
class InsertionGate {
 public:
  explicit InsertionGate(const InsertionConfig& config) : config_(config) {}
  bool admits(const estimation::ElasticMotion& motion, Verdict verdict);

 private:
  InsertionConfig config_;
  int skipped_ = 0;  ///< in a row
};

}  // namespace lidarena::odometry::arena_lo
