// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "lidarena/base/se3.hpp"
#include "lidarena/estimation/elastic_alignment.hpp"
#include "lidarena/odometry/arena_lo/config.hpp"
#include "lidarena/odometry/arena_lo/sampling.hpp"

namespace lidarena::odometry::arena_lo {

/// Last motions of the lidar, for the initial guess and the motion prior of the next scan.
class MotionHistory {
 public:
  /// Adds a scan's motion. A `lost` one is a prediction: the velocity is then multiplied by `kept`.
  void add(const estimation::ElasticMotion& motion, const estimation::ScanTimes& times, bool lost,
           double kept);

  /// Initial guess for the registration of the next scan (CT-ICP, III-A).
  estimation::ElasticMotion predict(const estimation::ScanTimes& times,
                                    const RegistrationConfig& config) const;

  /// Motion prior of the next scan (III-C): the end and the motion of the last one; with
  /// constant_twist the prediction, which is the same by real time.
  estimation::MotionPrior prior(const estimation::ElasticMotion& prediction,
                                const RegistrationConfig& config, const PriorConfig& weights) const;

 private:
  estimation::ElasticMotion constant_motion(int segments) const;
  estimation::ElasticMotion constant_twist(const estimation::ScanTimes& times, int segments) const;

  int scans_ = 0;
  estimation::ElasticMotion last_ = estimation::ElasticMotion::still(Pose::Identity(), 1);
  estimation::ElasticMotion before_ = last_;
  Time instant_{0};                            ///< of the last scan's end
  se3::Vector6 twist_ = se3::Vector6::Zero();  ///< m/s, rad/s, lidar
};

}  // namespace lidarena::odometry::arena_lo
