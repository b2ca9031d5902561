// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "lidarena/base/config_json.hpp"
#include "lidarena/base/trajectory.hpp"
#include "lidarena/dataset/points/cloud.hpp"
#include "lidarena/dataset/run_events.hpp"

namespace lidarena::dataset {

/// One row of resources.csv: state after one scan.
struct ResourceRow {
  double t_sensor_s = 0.0;  ///< end of the scan, since the first scan's stamp
  double latency_s = 0.0;   ///< wall time of register_scan
  double cpu_s =
      0.0;  ///< CPU time of register_imu since the scan before and register_scan, all threads
  std::uint64_t rss_bytes = 0;
  std::uint64_t pss_bytes = 0;
  std::uint64_t map_bytes = 0;  ///< this and the next two: as reported by the algorithm
  std::uint64_t scan_buffer_bytes = 0;
  std::uint64_t backlog_bytes = 0;
};

/// A RUN folder: trajectory.tum (final), live.tum, motion.tum (if the method tells it), map.ply,
/// reprojected.ply, resources.csv, events.csv, manifest.json (and, after evaluation, metrics.json).
struct RunFiles {
  Trajectory trajectory;  ///< after finish()
  Trajectory live;        ///< pose at each scan as estimated at that time
  Trajectory motion;      ///< final, with the motion within the scans; empty: the method tells none
  Cloud map;              ///< the map that the program publishes
  Cloud reprojected;      ///< scored returns placed by the estimated motion, first per 2 cm voxel
  std::vector<ResourceRow> resources;
  std::optional<std::vector<RunEvent>> events{};  ///< empty: not known
  Json manifest;
};

/// Writes the folder; manifest.json last, so that a folder without it is incomplete.
void write_run(const std::filesystem::path& folder, const RunFiles& run);
/// Reads it back; throws InputError when manifest.json is missing or a file is damaged.
RunFiles read_run(const std::filesystem::path& folder);
/// Reads a resources.csv alone; throws InputError naming file and line.
std::vector<ResourceRow> read_resources(const std::filesystem::path& file);

}  // namespace lidarena::dataset
