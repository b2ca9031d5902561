// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/odometry/arena_lo/prediction.hpp"

#include "lidarena/base/so3.hpp"

namespace lidarena::odometry::arena_lo {

void MotionHistory::add(const estimation::ElasticMotion& motion, const estimation::ScanTimes& times,
                        bool lost, double kept) {
  if (lost) {
    twist_ *= kept;
  } else if (times.timed) {
    twist_ = se3::log(motion.begin().inverse() * motion.end()) / times.seconds();
  } else if (scans_ > 0) {
    twist_ = se3::log(last_.end().inverse() * motion.end()) / to_seconds(times.last - instant_);
  }
  before_ = last_;
  last_ = motion;
  instant_ = times.last;
  ++scans_;
}

estimation::ElasticMotion MotionHistory::predict(const estimation::ScanTimes& times,
                                                 const RegistrationConfig& config) const {
  if (scans_ == 0) return estimation::ElasticMotion::still(Pose::Identity(), config.segments);
  switch (config.initial_motion) {
    case InitialMotion::kLastPose:
      break;
    case InitialMotion::kConstantMotion:
      return constant_motion(config.segments);
    case InitialMotion::kConstantTwist:
      return constant_twist(times, config.segments);
  }
  return estimation::ElasticMotion::still(last_.end(), config.segments);
}

estimation::ElasticMotion MotionHistory::constant_motion(int segments) const {
  if (scans_ < 2) return estimation::ElasticMotion::still(last_.end(), segments);
  if (scans_ == 2) {  // the first scans are rigid: begin where the last one ended
    const Pose end = last_.end() * before_.end().inverse() * last_.end();
    estimation::ElasticMotion motion = estimation::ElasticMotion::still(last_.end(), segments);
    for (std::size_t i = 0; i < motion.knots.size(); ++i) {
      const double alpha = static_cast<double>(i) / static_cast<double>(segments);
      motion.knots[i] = interpolate(last_.end(), end, alpha);
    }
    return motion;
  }
  estimation::ElasticMotion motion = last_;
  for (std::size_t i = 0; i < motion.knots.size(); ++i)
    motion.knots[i] = last_.knots[i] * before_.knots[i].inverse() * last_.knots[i];
  return motion;
}

estimation::ElasticMotion MotionHistory::constant_twist(const estimation::ScanTimes& times,
                                                        int segments) const {
  estimation::ElasticMotion motion;
  for (int i = 0; i <= segments; ++i) {
    const Time instant = times.first + (times.last - times.first) * i / segments;
    motion.knots.push_back(last_.end() * se3::exp(twist_ * to_seconds(instant - instant_)));
  }
  return motion;
}

estimation::MotionPrior MotionHistory::prior(const estimation::ElasticMotion& prediction,
                                             const RegistrationConfig& config,
                                             const PriorConfig& weights) const {
  const bool timed = config.initial_motion == InitialMotion::kConstantTwist;
  const estimation::ElasticMotion& alike = timed ? prediction : last_;
  estimation::MotionPrior prior;
  prior.begin = timed ? prediction.begin() : last_.end();
  prior.step = alike.end().translation() - alike.begin().translation();
  prior.turn = so3::log(alike.end().linear() * alike.begin().linear().transpose());
  prior.location = weights.location;
  prior.orientation = weights.orientation;
  prior.velocity = weights.velocity;
  prior.angular_velocity = weights.angular_velocity;
  prior.small_velocity = weights.small_velocity;
  prior.velocity_change = weights.velocity_change;
  prior.angular_velocity_change = weights.angular_velocity_change;
  return prior;
}

}  // namespace lidarena::odometry::arena_lo
