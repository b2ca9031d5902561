// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "lidarena/base/se3.hpp"
#include "lidarena/estimation/elastic_alignment.hpp"
#include "lidarena/estimation/scan_times.hpp"
#include "lidarena/odometry/arena_lo/config.hpp"

namespace lidarena::odometry::arena_lo {

/// What is known of a scan's motion before it is registered.
struct Expectation {
  estimation::ElasticMotion guess;  ///< where the registration starts
  estimation::MotionPrior prior;
};

/// The last pose and velocity of the lidar, which predict the next scan by real time, so that a
/// dropped scan causes no error.
class MotionHistory {
 public:
  /// Adds the motion of a registered scan.
  void add(const estimation::ElasticMotion& motion, const estimation::ScanTimes& times);
  /// Adds the prediction of a scan that could not be registered: the velocity is halved.
  void add_lost(const estimation::ElasticMotion& motion, const estimation::ScanTimes& times);

  /// The motion with the last velocity: the guess and what the prior expects.
  Expectation expect(const estimation::ScanTimes& times, int segments,
                     const PriorConfig& weights) const;

 private:
  bool empty_ = true;
  Pose end_ = Pose::Identity();                ///< of the last scan, map from lidar
  Time instant_{0};                            ///< of that pose
  se3::Vector6 twist_ = se3::Vector6::Zero();  ///< m/s, rad/s, lidar
};

}  // namespace lidarena::odometry::arena_lo
