// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "lidarena/base/config.hpp"
#include "lidarena/odometry/odometry.hpp"

namespace lidarena::odometry {

struct TrackingConfig {
  double min_inlier_share = 0.75;

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("min_inlier_share", self.min_inlier_share, "",
      "a scan is not added to the map when the share of its points that lie on their planes is "
      "smaller than this times the usual share; after fifteen such scans in a row the status is "
      "diverged",
      between(0, 1));
  }
};

/// Judges from scan to scan whether a map is followed.
class Tracking {
 public:
  explicit Tracking(const TrackingConfig& config) : config_(config) {}

  /// Status of a scan of which the share `inliers` of points lies in the map: degenerate if it
  /// contradicts the map or leaves a direction open.
  ScanStatus judge(double inliers, bool leaves_open);
  /// From now on tracking is lost.
  void give_up();
  /// Whether the last scan contradicts the map, or tracking is lost.
  bool contradicts() const { return contradicting_scans_ > 0; }
  /// Whether many scans in a row contradict the map.
  bool is_lost() const;

 private:
  TrackingConfig config_;
  std::optional<double> usual_share_;  ///< running mean of the share of inliers
  int contradicting_scans_ = 0;        ///< in a row
};

}  // namespace lidarena::odometry
