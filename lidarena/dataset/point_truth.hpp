// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "lidarena/base/time.hpp"

namespace lidarena {

/// What a simulated return really hit, 32 bytes. For evaluation alone: it travels beside the
/// measurements (topic /truth/SENSOR/hits), never inside what an odometry is given.
struct PointTruth {
  Eigen::Vector3f position = Eigen::Vector3f::Zero();  ///< m, world frame, on the surface
  float range = 0.0F;                                  ///< m, true, counted as the sensor's range
  Eigen::Vector3f normal = Eigen::Vector3f::Zero();    ///< unit, world frame, towards the sensor
  std::uint32_t triangle = 0;                          ///< index into the world's mesh
};
static_assert(sizeof(PointTruth) == 32);

/// Truth of one scan: as many points as the scan has, in the same order.
struct ScanTruth {
  std::string sensor_id;
  Time stamp{0};  ///< the scan's
  std::vector<PointTruth> points;
};

/// Truth of scan after scan; empty at the end.
class ScanTruthSource {
 public:
  virtual ~ScanTruthSource() = default;
  virtual std::optional<ScanTruth> next() = 0;
};

/// Takes the truth of each scan as it is made.
class ScanTruthSink {
 public:
  virtual ~ScanTruthSink() = default;
  virtual void write(const ScanTruth& truth) = 0;
};

}  // namespace lidarena
