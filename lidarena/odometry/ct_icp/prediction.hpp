// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "lidarena/odometry/ct_icp/alignment.hpp"
#include "lidarena/odometry/ct_icp/config.hpp"

namespace lidarena::odometry::ct_icp {

/// What is known of a scan's motion before it is registered.
struct Expectation {
  ElasticMotion guess;  ///< where the registration starts
  MotionPrior prior;
};

/// The last motions of the lidar in the map. They count by scans, whatever the time between.
class MotionHistory {
 public:
  void add(const ElasticMotion& motion);

  /// The pose (map from lidar) at which the last scan ended.
  const Pose& last_end() const { return last_.end; }
  /// Initial guess for the next scan (CT-ICP, III-A).
  ElasticMotion predict(InitialMotion initial_motion) const;
  /// Motion prior of the next scan (III-C): the end and the motion of the last one.
  MotionPrior prior(const PriorConfig& weights) const;

 private:
  int scans_ = 0;
  ElasticMotion last_;
  ElasticMotion before_;
};

}  // namespace lidarena::odometry::ct_icp
