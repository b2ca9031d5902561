// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "lidarena/base/event.hpp"
#include "lidarena/base/log.hpp"
#include "lidarena/base/parallel.hpp"
#include "lidarena/base/point_truth.hpp"
#include "lidarena/base/rig.hpp"
#include "lidarena/flight/flight.hpp"
#include "lidarena/sensor/sensor_config.hpp"
#include "lidarena/world/surfaces.hpp"

namespace lidarena::sensor {

struct SimulationOptions {
  std::uint64_t seed = 1;
  Time duration{0};  ///< 0 = the whole flight
  bool noise = true;
  std::string lidar{};             ///< id of the only LiDAR to simulate, with all IMUs; empty = all
  ScanTruthSink* truth = nullptr;  ///< receives a scan's truth just before next() returns the scan
};

/// The rig of these sensors on one body (each LiDAR with its IMU, if it has one). Ids are the
/// sensors' names, made unique; a LiDAR and the IMU inside it share the id (topics /ID/points and
/// /ID/imu). The IMU is described as SensorConfig::told says. Throws InputError if a model does not
/// have the configured mode.
Rig make_rig(const std::vector<SensorConfig>& sensors);

/// Simulates the measurements of a flight, each when it is requested, in the order that EventSource
/// specifies; identical for the same seed on any number of threads. Keeps references to `world` and
/// `flight`. Times count from the flight's start, by the clock of each sensor: scan k begins at
/// k * period of true time, and only complete scans are simulated. A scan is delivered once every
/// IMU has delivered a sample at or after the scan's last firing (or has ended).
std::unique_ptr<EventSource> simulate(const world::Surfaces& world, const flight::Flight& flight,
                                      const std::vector<SensorConfig>& sensors,
                                      const SimulationOptions& options, const Parallel& parallel);

}  // namespace lidarena::sensor
