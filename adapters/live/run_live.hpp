// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>

#include "lidarena/stages/config_folder.hpp"
#include "lidarena/stages/run_algorithm.hpp"

namespace lidarena::live {

/// Options of `run --live`.
struct LiveRun {
  bool asked = false;
  std::string points_topic, imu_topic;  ///< empty: /SENSOR/points, /SENSOR/imu
  double idle_s = 2.0;
  int queue = 0;  ///< scans that may wait while the algorithm is busy; 0: all
  int domain = -1;
  bool network = false;
};

/// Runs the algorithm on live topics of the sensor `request.read.sensor` (of the configurations)
/// until nothing comes any more or Ctrl-C, publishes its poses, and writes the RUN folder `out`.
/// The dataset of the request, if there is one, is what the run is scored against.
odometry::RunSummary run_live(const LiveRun& run, const stages::RunRequest& request,
                              const stages::ConfigFolder& configs, const std::filesystem::path& out,
                              const Parallel& parallel, LogSink& log);

}  // namespace lidarena::live
