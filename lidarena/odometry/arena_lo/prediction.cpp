// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/odometry/arena_lo/prediction.hpp"

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
  Expectation expected{predict(times, segments), {}};
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

estimation::ElasticMotion MotionHistory::predict(const estimation::ScanTimes& times,
                                                 int segments) const {
  if (empty_) return estimation::ElasticMotion::still(Pose::Identity(), segments);
  estimation::ElasticMotion motion;
  for (int i = 0; i <= segments; ++i) {
    const Time instant = times.first + (times.last - times.first) * i / segments;
    motion.knots.push_back(end_ * se3::exp(twist_ * to_seconds(instant - instant_)));
  }
  return motion;
}

}  // namespace lidarena::odometry::arena_lo
