// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "lidarena/odometry/ct_icp/elastic_motion.hpp"

namespace lidarena::odometry::ct_icp {

/// Whether a scan's motion is one that the published program accepts: finite, at most 5 m from
/// begin to end, and at most 30 deg from begin to end and from `last_end`, the end of the scan
/// before, to its end.
bool is_plausible(const ElasticMotion& motion, const Pose& last_end);

/// Decides which scans enter the map (CT-ICP, III-E): those that rotate by more than 3 deg are
/// skipped, unless more than five in a row were.
class InsertionGate {
 public:
  bool admits(const ElasticMotion& motion);

 private:
  int skipped_ = 0;  ///< in a row
};

}  // namespace lidarena::odometry::ct_icp
