// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/odometry/arena_lo/prediction.hpp"

#include "lidarena/estimation/elastic_scan.hpp"

namespace lidarena::odometry::arena_lo {

namespace {
constexpr double kLostMotionFactor = 0.5;  // on the velocity after each scan without registration
}

void MotionHistory::add(const estimation::ElasticMotion& motion,
                        const estimation::ScanTimes& times) {
  if (times.timed) {
    twist_ = se3::log(motion.begin().inverse() * motion.end()) / times.seconds();
  } else if (!empty_) {
    twist_ = se3::log(end_.inverse() * motion.end()) / to_seconds(times.last - instant_);
  }
  end_ = motion.end();
  instant_ = times.last;
  empty_ = false;
}

void MotionHistory::add_lost(const estimation::ElasticMotion& motion,
                             const estimation::ScanTimes& times) {
  twist_ *= kLostMotionFactor;
  end_ = motion.end();
  instant_ = times.last;
  empty_ = false;
}

Expectation MotionHistory::expect(const estimation::ScanTimes& times, int segments,
                                  const PriorConfig& weights) const {
  Expectation expected{
      empty_ ? estimation::ElasticMotion::still(Pose::Identity(), segments)
             : estimation::constant_twist_motion({instant_, end_}, twist_, times, segments),
      {}};
  const Pose& begin = expected.guess.begin();
  expected.prior.begin = begin;
  expected.prior.step = expected.guess.end().translation() - begin.translation();
  expected.prior.location = weights.location;
  expected.prior.orientation = weights.orientation;
  expected.prior.velocity = weights.velocity;
  expected.prior.velocity_change = weights.velocity_change;
  expected.prior.angular_velocity_change = weights.angular_velocity_change;
  return expected;
}

}  // namespace lidarena::odometry::arena_lo
