// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>

#include "lidarena/base/pose.hpp"
#include "lidarena/odometry/kiss_icp/config.hpp"

namespace lidarena::kiss_icp {

/// How far a prediction `error` (true pose seen from the predicted one) moves a point at `range` m,
/// at most: |t| + 2 range sin(angle / 2) (paper, eq. 5 and 6).
double displacement(const Pose& error, double range);

/// Sigma of the constant-velocity prediction's errors so far, m (paper, eq. 8): how far apart a
/// point and its counterpart may be before ICP.
class AdaptiveThreshold {
 public:
  explicit AdaptiveThreshold(const Config& config);

  double sigma() const;
  /// `prediction` and `estimate` of the same pose; `mean_range` (m) of the points that show it.
  void observe(const Pose& prediction, const Pose& estimate, double mean_range);

 private:
  double initial_;
  double min_motion_;
  double range_;
  ThresholdStart start_;
  ThresholdLever lever_;
  double kept_;         ///< share of the past that is kept at each error seen
  bool moved_ = false;  ///< beyond 5 minimum motions from the start
  double squared_sum_ = 0.0;
  double count_ = 0.0;
};

}  // namespace lidarena::kiss_icp
