// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <optional>
#include <string>

#include "lidarena/base/event.hpp"
#include "lidarena/base/log.hpp"
#include "lidarena/odometry/odometry.hpp"

namespace lidarena::odometry {

struct RunOptions {
  std::string lidar_id{};                   ///< scans of other LiDARs are skipped
  std::string imu_id{};                     ///< the IMU to use; empty: the first in the events
  std::optional<std::size_t> scan_count{};  ///< for the progress display
  bool paced = false;                       ///< drop scans when the algorithm is late, see Pacer
};

struct RunSummary {
  std::map<ScanStatus, std::size_t> statuses;
  std::size_t scans = 0;         ///< registered
  std::size_t refused = 0;       ///< not registered because they were out of time order
  std::size_t dropped = 0;       ///< not registered because the algorithm was late; paced runs only
  double longest_delay_s = 0.0;  ///< from a scan's last point to its estimate; paced runs only
  double sensor_seconds = 0.0;
  double compute_seconds = 0.0;   ///< wall time inside the algorithm
  bool diverged = false;          ///< a status was kDiverged, or a pose was not finite
  std::string reason;             ///< why it diverged
  std::string recording_ended{};  ///< where the input was cut off or damaged; empty if it was not
};

/// What one scan took.
struct ScanCost {
  double latency_s = 0.0;  ///< wall time of register_scan()
  double cpu_s = 0.0;      ///< CPU time of it and of register_imu() since the scan before
};

/// Receives what the odometry was given and what came of it.
class RunObserver {
 public:
  virtual ~RunObserver() = default;
  virtual void take(const ImuSample&) {}
  virtual void take(const Scan& scan, const ScanResult& result, const ScanCost& cost) = 0;
};

/// Feeds `events` to `odometry` until they end or it diverges, then finishes it, unless it has
/// diverged. A paced run depends on the speed of the machine, so it is not repeatable.
RunSummary run(Odometry& odometry, EventSource& events, const RunOptions& options,
               RunObserver& observer, LogSink& log);

}  // namespace lidarena::odometry
