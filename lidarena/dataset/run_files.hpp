// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "lidarena/base/trajectory.hpp"
#include "lidarena/dataset/points/cloud.hpp"
#include "lidarena/dataset/run_events.hpp"
#include "lidarena/dataset/run_manifest.hpp"

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
  /// The map that the program publishes, and the scored returns placed by the estimated motion,
  /// first per 2 cm voxel. Not written if they are already on the disk.
  Cloud map, reprojected;
  bool maps_on_disk = false;
  std::vector<ResourceRow> resources;
  std::optional<std::vector<RunEvent>> events{};  ///< empty: not known
  RunManifest manifest;
};

/// Creates the folder, or removes from it what would make it look like a finished run.
void begin_run(const std::filesystem::path& folder);
/// Writes the folder; manifest.json last, so that a folder without it is incomplete.
void write_run(const std::filesystem::path& folder, const RunFiles& run);
enum class ReadMaps { kYes, kNo };
/// Reads it back; throws InputError when manifest.json or a map that is wanted is missing, or a
/// file is damaged.
RunFiles read_run(const std::filesystem::path& folder, ReadMaps maps = ReadMaps::kYes);
/// Reads a resources.csv alone; throws InputError naming file and line.
std::vector<ResourceRow> read_resources(const std::filesystem::path& file);

}  // namespace lidarena::dataset
