// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/odometry/ct_icp/quality.hpp"

#include "lidarena/base/angle.hpp"
#include "lidarena/base/so3.hpp"

namespace lidarena::odometry::ct_icp {

namespace {

// Limits of the published program, none of which its configuration files set.
constexpr double kMaxTranslation = 5.0;              // m
constexpr double kMaxRotation = 30.0 * kDegree;      // rad
constexpr double kInsertedRotation = 3.0 * kDegree;  // rad, from begin to end
constexpr int kMaxSkipped = 5;                       // scans in a row

double rotation_between(const Pose& a, const Pose& b) {
  return so3::angle(a.linear().transpose() * b.linear());
}

}  // namespace

bool is_plausible(const ElasticMotion& motion, const Pose& last_end) {
  const Pose& begin = motion.begin;
  const Pose& end = motion.end;
  return begin.matrix().allFinite() && end.matrix().allFinite() &&
         (end.translation() - begin.translation()).norm() <= kMaxTranslation &&
         rotation_between(begin, end) <= kMaxRotation &&
         rotation_between(last_end, end) <= kMaxRotation;
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
