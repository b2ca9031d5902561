// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>

#include "lidarena/odometry/ct_icp/registration.hpp"

namespace lidarena::ct_icp {

/// The settings of a level above 0: keypoints 1.5 times as fine and twice as many, 20 more
/// iterations and 30 more of the solver, a tenth of the thresholds that end them, a loss 1.2 and a
/// gate 1.5 times as wide, each once a level (iterations, too).
Config at_level(Config config, int level);

/// What a registration is worth.
enum class Verdict {
  kTrusted,
  kSuspect,  ///< turns more, or matches less, than RobustConfig trusts
  kLost,     ///< too few residuals, or farther or further round than can be
};
Verdict verdict_on(const Registration& registration, const ElasticMotion& guess,
                   const RobustConfig& config);

struct RobustRegistration {
  Registration registration;
  Verdict verdict = Verdict::kTrusted;
  int level = 0;
};

/// Registers the keypoints of `frame`; while the outcome is not trusted, again from the same guess
/// at the next level, from `first_level` on and with max_attempts in all (one if not
/// `config.robust.enabled`). `starting`: one of the first scans.
RobustRegistration register_robustly(std::span<const TimedPoint> frame, const VoxelHashMap& map,
                                     const ElasticMotion& guess, const MotionPrior& prior,
                                     const Config& config, bool starting, int first_level,
                                     const Parallel& parallel);

/// Decides which scans enter the map: not suspect ones, until too many were kept out in a row.
class InsertionGate {
 public:
  explicit InsertionGate(const InsertionConfig& config) : config_(config) {}
  bool admits(const ElasticMotion& motion, Verdict verdict);

 private:
  InsertionConfig config_;
  int skipped_ = 0;  ///< in a row
};

}  // namespace lidarena::ct_icp
