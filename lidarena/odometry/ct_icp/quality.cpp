// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/odometry/ct_icp/quality.hpp"

#include "lidarena/base/angle.hpp"
#include "lidarena/base/so3.hpp"

namespace lidarena::odometry::ct_icp {

namespace {

// Of the published program, whose reader of configuration files does not know them.
constexpr double kInsertedRotation = 3.0 * kDegree;  // rad, from begin to end
constexpr int kMaxSkipped = 5;                       // scans in a row

}  // namespace

double rotation_between(const Pose& a, const Pose& b) {
  return so3::angle(a.linear().transpose() * b.linear());
}

bool is_plausible(const ElasticMotion& motion, const Pose& last_end,
                  const RegistrationConfig& limits) {
  const double max_rotation = limits.max_rotation_deg * kDegree;
  const Pose& begin = motion.begin;
  const Pose& end = motion.end;
  return begin.matrix().allFinite() && end.matrix().allFinite() &&
         (end.translation() - begin.translation()).norm() <= limits.max_translation_m &&
         rotation_between(begin, end) <= max_rotation &&
         rotation_between(last_end, end) <= max_rotation;
}

bool InsertionGate::admits(const ElasticMotion& motion) {
  if (rotation_between(motion.begin, motion.end) > kInsertedRotation && skipped_ <= kMaxSkipped) {
    ++skipped_;
    return false;
  }
  skipped_ = 0;
  return true;
}

}  // namespace lidarena::odometry::ct_icp
