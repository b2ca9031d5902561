// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/odometry/ct_icp/prediction.hpp"

namespace lidarena::odometry::ct_icp {

namespace {

/// The motion from `before` to `last`, once more.
Pose repeated(const Pose& before, const Pose& last) { return last * before.inverse() * last; }

}  // namespace

void MotionHistory::add(const ElasticMotion& motion) {
  before_ = last_;
  last_ = motion;
  ++scans_;
}

ElasticMotion MotionHistory::predict(InitialMotion initial_motion) const {
  if (initial_motion == InitialMotion::kLastPose || scans_ < 2)
    return ElasticMotion::still(last_.end);
  const Pose end = repeated(before_.end, last_.end);
  // The first two scans are rigid: the third one begins where the second ended.
  if (scans_ == 2) return {last_.end, end};
  return {repeated(before_.begin, last_.begin), end};
}

MotionPrior MotionHistory::prior(const PriorConfig& weights) const {
  MotionPrior prior;
  prior.begin = last_.end;
  prior.step = last_.end.translation() - last_.begin.translation();
  prior.location = weights.location;
  prior.velocity = weights.velocity;
  prior.orientation = weights.orientation;
  prior.small_velocity = weights.small_velocity;
  return prior;
}

}  // namespace lidarena::odometry::ct_icp
