// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "lidarena/base/time.hpp"

namespace lidarena::sensor {

/// One shot of a LiDAR, in the lidar frame.
struct Beam {
  Eigen::Vector3f direction;  ///< unit
  std::int32_t dt_ns = 0;     ///< since the scan's first firing
  std::uint16_t ring = 0;     ///< row of a spinning sensor, laser line of a Livox
  Eigen::Vector3f origin = Eigen::Vector3f::Zero();  ///< where the beam starts, m, lidar frame
};

/// Firing directions and times of a LiDAR: a pure function of the scan's index, so any thread may
/// request any scan.
class ScanPattern {
 public:
  virtual ~ScanPattern() = default;
  virtual Time period() const = 0;  ///< from one scan's stamp to the next
  virtual std::size_t beams_per_scan() const = 0;
  /// Replaces `out` by the beams of scan `index`, in firing order.
  virtual void beams(std::uint64_t index, std::vector<Beam>& out) const = 0;
  /// Number of scans after which the beams repeat bit for bit; 0: never.
  virtual std::uint64_t repeats_after() const { return 0; }
};

}  // namespace lidarena::sensor
