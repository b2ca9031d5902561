// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "lidarena/flight/flight.hpp"

namespace lidarena {

/// Where a lidar is during one scan, cheap to ask for every shot. The flight is sampled every
/// 1.33 ms; between the samples a cubic runs through four of them, position and rotation matrix
/// alike, whose error is h^4 |f''''| / 1944 with h = 4 ms. Where the flight itself, asked halfway
/// between samples, differs from the cubic by more than 1e-7 m or 1e-9 in the matrix (a kink, a
/// jump), that stretch is not interpolated but asked of the flight shot by shot. So a point at
/// 100 m is off by less than 1e-6 m.
class LidarMotion {
 public:
  /// Poses from `stamp` to `last_dt_ns` after it, or, when not `rolling`, the one at the stamp.
  /// Keeps a reference to `flight`.
  LidarMotion(const Flight& flight, const Pose& body_from_lidar, Time stamp,
              std::int32_t last_dt_ns, bool rolling);

  /// world_from_lidar at `dt_ns` >= 0 after the stamp; after last_dt_ns the flight is asked.
  Pose at(std::int32_t dt_ns) const;

  /// Share of the scan that is asked of the flight itself.
  double exact_share() const;

 private:
  using Matrix34 = Eigen::Matrix<double, 3, 4>;

  Pose exact(Time after_stamp) const;
  Matrix34 cubic(std::size_t segment, double x) const;
  bool is_smooth(std::size_t segment) const;

  const Flight& flight_;
  Pose body_from_lidar_;
  Time stamp_;
  std::vector<Matrix34> samples_;  ///< three a segment, and the last; one alone when not rolling
  std::vector<bool> smooth_;       ///< of each segment
};

}  // namespace lidarena
