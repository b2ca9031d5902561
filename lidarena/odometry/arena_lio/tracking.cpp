// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/odometry/arena_lio/tracking.hpp"

#include <Eigen/Eigenvalues>

namespace lidarena::odometry::arena_lio {
namespace {

constexpr int kLostScans = 15;        // in a row that contradict the map: tracking is lost
constexpr double kDegenerate = 0.01;  // minimum share of a direction; isotropic: 1/3
constexpr double kShareMemory = 0.1;  // weight of a scan in the usual share of inliers

}  // namespace

ScanStatus Tracking::judge(const estimation::IteratedUpdate& update, const Agreement& agreement,
                           bool map_is_empty) {
  if (!estimation::is_plausible(update.estimate.state)) {
    contradicting_scans_ = kLostScans + 1;
    return ScanStatus::kDiverged;
  }
  if (agreement.points == 0) return ScanStatus::kTooFewPoints;
  if (map_is_empty) return ScanStatus::kInitializing;
  if (contradicting_scans_ > kLostScans) return ScanStatus::kDiverged;  // permanently
  if (agreement.near_planes == 0) return ScanStatus::kTooFewPoints;
  const double share = agreement.share;
  const bool contradicts = share < min_inlier_share_ * usual_share_.value_or(share);
  contradicting_scans_ = contradicts ? contradicting_scans_ + 1 : 0;
  if (contradicts) return ScanStatus::kDegenerate;
  usual_share_ = usual_share_.value_or(share) * (1.0 - kShareMemory) + kShareMemory * share;
  // The block of the position is the weighted sum of n n^T over all normals n.
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> directions(
      update.points.hessian.topLeftCorner<3, 3>(), Eigen::EigenvaluesOnly);
  const double weakest = directions.eigenvalues()[0] / directions.eigenvalues().sum();
  return weakest < kDegenerate ? ScanStatus::kDegenerate : ScanStatus::kTracked;
}

}  // namespace lidarena::odometry::arena_lio
