// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "lidarena/base/parallel.hpp"
#include "lidarena/base/random.hpp"
#include "lidarena/base/scan.hpp"
#include "lidarena/dataset/point_truth.hpp"
#include "lidarena/flight/flight.hpp"
#include "lidarena/sensor/scan_pattern.hpp"
#include "lidarena/sensor/sensor_config.hpp"
#include "lidarena/world/world.hpp"

namespace lidarena {

/// A LiDAR flown through a world. measure() is const and keyed by (seed, id, ray number), so scans
/// can be made in any order and on any number of threads with identical bytes.
class Lidar {
 public:
  /// Copies `config`; `id` keys the noise; without `noise` the ranges are exact.
  Lidar(const SensorConfig& config, std::unique_ptr<ScanPattern> pattern, const std::string& id,
        std::uint64_t seed, bool noise);

  /// Scan `index`, which begins at index * period. Each shot is cast from the pose at its own
  /// instant (see ScanMode); shots without a return are left out. Ranges count from the sensor's
  /// axis (|beam origin| + the way flown) and are kept when the true range lies within the
  /// limits. Intensity is lambert_intensity(). `truth`, if given, receives what every point really
  /// hit, in point order; its range counts as the point's does.
  Scan measure(const World& world, const Flight& flight, std::uint64_t index,
               const Parallel& parallel, std::vector<PointTruth>* truth = nullptr) const;

  const ScanPattern& pattern() const { return *pattern_; }
  Time stamp(std::uint64_t index) const;
  /// Instant of the last firing of scan `index`, whether or not its points carry times.
  Time last_firing(std::uint64_t index) const;

 private:
  SensorConfig config_;
  std::unique_ptr<ScanPattern> pattern_;
  CounterRandom random_;
  std::int32_t last_dt_ns_ = 0;
};

/// Value of a perfectly white, diffuse surface, 0..255: 255 cos(incidence). The sensors report
/// reflectivity with the loss by range taken out, so range does not enter.
float lambert_intensity(const Eigen::Vector3f& direction, const Eigen::Vector3f& normal);

}  // namespace lidarena
