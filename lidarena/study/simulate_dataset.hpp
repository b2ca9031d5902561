// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "lidarena/base/config_json.hpp"
#include "lidarena/base/log.hpp"
#include "lidarena/base/parallel.hpp"
#include "lidarena/dataset/dataset.hpp"
#include "lidarena/sensor/sensor_config.hpp"

namespace lidarena {

/// What `lidarena simulate` is asked for. Files are resolved already.
struct SimulateRequest {
  std::filesystem::path world;
  std::filesystem::path flight;
  std::vector<std::filesystem::path> sensors;
  std::uint64_t seed = 1;  ///< of all noise; a procedural world's own seed stands in its file
  double seconds = 0.0;    ///< 0 = the whole flight
  bool noise = true;
  std::optional<ScanMode> mode;  ///< of all sensors; empty = as their files say
  bool data = true;              ///< false: a manifest alone, flown anew whenever it is used
  bool truth = false;            ///< also what each point hit, as /truth/SENSOR/hits
  WriteOptions write;            ///< format and dialect of the measurements
};

/// Counts and sizes of what was simulated.
struct SimulateSummary {
  std::size_t triangles = 0;
  std::size_t scans = 0;
  std::size_t points = 0;
  std::size_t imu_samples = 0;
  double seconds = 0.0;  ///< of flight
  double path_m = 0.0;   ///< flown
};

/// Flies the request and writes the dataset folder `out`: world.ply, truth.tum (1 kHz), data.mcap
/// (or as `write` says) unless it is a manifest alone, and manifest.json last.
SimulateSummary simulate_dataset(const SimulateRequest& request, const std::filesystem::path& out,
                                 const Parallel& parallel, LogSink& log);

/// open_dataset(), and also datasets that are a manifest alone: these are flown on the fly, with
/// the same points as if they had been written.
Dataset open_any_dataset(const std::filesystem::path& path, const ReadOptions& options,
                         const Parallel& parallel);

}  // namespace lidarena
