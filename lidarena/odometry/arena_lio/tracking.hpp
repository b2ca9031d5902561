// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "lidarena/estimation/iterated_update.hpp"
#include "lidarena/odometry/arena_lio/plane_residuals.hpp"
#include "lidarena/odometry/odometry.hpp"

namespace lidarena::odometry::arena_lio {

/// Judges from scan to scan whether the map is followed.
class Tracking {
 public:
  /// `min_inlier_share`: of the usual share of inliers, below which a scan contradicts the map.
  explicit Tracking(double min_inlier_share) : min_inlier_share_(min_inlier_share) {}

  /// Status of the next scan. Diverged, and permanently so, if the state is not plausible or after
  /// many scans in a row that contradict the map.
  ScanStatus judge(const estimation::IteratedUpdate& update, const Agreement& agreement,
                   bool map_is_empty);
  /// Whether the last scan contradicts the map, or tracking is lost.
  bool contradicts() const { return contradicting_scans_ > 0; }

 private:
  double min_inlier_share_;
  std::optional<double> usual_share_;  ///< of a scan's points that lie on their planes
  int contradicting_scans_ = 0;        ///< in a row
};

}  // namespace lidarena::odometry::arena_lio
