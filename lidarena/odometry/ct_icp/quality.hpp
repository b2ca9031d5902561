// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "lidarena/odometry/ct_icp/config.hpp"
#include "lidarena/odometry/ct_icp/elastic_motion.hpp"

namespace lidarena::odometry::ct_icp {

/// Angle (rad) between two orientations.
double rotation_between(const Pose& a, const Pose& b);

/// Whether a scan's motion is one that is accepted: finite, at most max_translation_m from begin to
/// end, and at most max_rotation_deg from begin to end and from `last_end`, the end of the scan
/// before, to its end.
bool is_plausible(const ElasticMotion& motion, const Pose& last_end,
                  const RegistrationConfig& limits);

/// Decides which scans enter the map (CT-ICP, III-E): those that rotate by more than 3 deg are
/// skipped, unless more than five in a row were.
class InsertionGate {
 public:
  bool admits(const ElasticMotion& motion);

 private:
  int skipped_ = 0;  ///< in a row
};

}  // namespace lidarena::odometry::ct_icp
