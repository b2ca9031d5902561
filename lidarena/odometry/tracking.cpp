// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/odometry/tracking.hpp"

namespace lidarena::odometry {
namespace {

constexpr int kLostScans = 15;        // in a row that contradict the map: tracking is lost
constexpr double kShareMemory = 0.1;  // weight of a scan in the usual share of inliers

}  // namespace

ScanStatus Tracking::judge(double inliers, bool leaves_open) {
  const double usual = usual_share_.value_or(inliers);
  const bool contradicts = inliers < config_.min_inlier_share * usual;
  contradicting_scans_ = contradicts ? contradicting_scans_ + 1 : 0;
  if (contradicts) return ScanStatus::kDegenerate;
  usual_share_ = usual * (1.0 - kShareMemory) + kShareMemory * inliers;
  return leaves_open ? ScanStatus::kDegenerate : ScanStatus::kTracked;
}

void Tracking::give_up() { contradicting_scans_ = kLostScans + 1; }

bool Tracking::is_lost() const { return contradicting_scans_ > kLostScans; }

}  // namespace lidarena::odometry
