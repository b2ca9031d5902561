// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <string>
#include <vector>

#include "lidarena/base/log.hpp"
#include "lidarena/dataset/event.hpp"
#include "lidarena/dataset/run_files.hpp"
#include "lidarena/odometry/odometry.hpp"

namespace lidarena::odometry {

struct RunOptions {
  std::string lidar_id{};                   ///< scans of other LiDARs are skipped
  std::string imu_id{};                     ///< the IMU to use; empty: the first in the events
  std::optional<std::size_t> scan_count{};  ///< for the progress display
  double map_voxel_size_m = 0.02;           ///< map.ply keeps the first point of each voxel
  bool paced = false;                       ///< drop scans when the algorithm is late, see Pacer
};

struct RunSummary {
  std::map<ScanStatus, std::size_t> statuses;
  std::size_t scans = 0;         ///< registered
  std::size_t dropped = 0;       ///< not registered because the algorithm was late; paced runs only
  double longest_delay_s = 0.0;  ///< from a scan's last point to its estimate; paced runs only
  double sensor_seconds = 0.0;
  double compute_seconds = 0.0;   ///< wall time inside the algorithm
  bool diverged = false;          ///< a status was kDiverged, or a pose was not finite
  std::string reason;             ///< why it diverged
  std::string recording_ended{};  ///< where the input was cut off or damaged; empty if it was not
};

struct RunResult {
  dataset::RunFiles files;  ///< all except `reprojected` and `manifest`
  RunSummary summary;
};

/// Feeds `events` to `odometry` and collects the results. A paced run depends on the speed of the
/// machine, so it is not repeatable.
RunResult run(Odometry& odometry, dataset::EventSource& events, const RunOptions& options,
              LogSink& log);

}  // namespace lidarena::odometry
