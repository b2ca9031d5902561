// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "lidarena/flight/flight.hpp"

namespace lidarena::sensor {

/// Pose of a lidar during one scan, cheap enough to evaluate for every shot. The flight is sampled
/// every 1.33 ms; position and rotation matrix are interpolated by a cubic through four consecutive
/// samples (a segment), with an error of h^4 |f''''| / 1944, h = 4 ms. Where the flight halfway
/// between samples differs from the cubic by more than 1e-7 m or 1e-9 in the matrix (a kink, a
/// jump), the segment is not interpolated; the flight is evaluated for each shot. So a point at
/// 100 m is off by less than 1e-6 m.
class LidarMotion {
 public:
  /// Poses from `stamp` until `last_dt_ns` later; if not `rolling`, only the pose at the stamp.
  /// Keeps a reference to `flight`.
  LidarMotion(const flight::Flight& flight, const Pose& body_from_lidar, Time stamp,
              std::int32_t last_dt_ns, bool rolling);

  /// world_from_lidar at `dt_ns` >= 0 after the stamp; after last_dt_ns the flight is evaluated.
  Pose at(std::int32_t dt_ns) const;

  /// Share of the scan for which the flight itself is evaluated, 0..1.
  double exact_share() const;

 private:
  using Matrix34 = Eigen::Matrix<double, 3, 4>;

  Pose exact(Time after_stamp) const;
  Matrix34 cubic(std::size_t segment, double x) const;
  bool is_smooth(std::size_t segment) const;

  const flight::Flight& flight_;
  Pose body_from_lidar_;
  Time stamp_;
  std::vector<Matrix34> samples_;  ///< three per segment, and the last; only one if not rolling
  std::vector<bool> smooth_;       ///< whether each segment is interpolated
};

}  // namespace lidarena::sensor
