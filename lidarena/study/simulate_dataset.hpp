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
  bool scored_only = false;      ///< of each scan the returns alone that scoring looks at
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

/// Folder in a dataset that is a manifest alone: its scored returns and what they hit, written once
/// so that the flight need not be flown for each score. May be deleted at any time.
inline constexpr const char* kScoredFolder = "scored";
void write_scored_returns(const SimulateRequest& request, const std::filesystem::path& dataset,
                          const Parallel& parallel, LogSink& log);

/// The returns of the dataset that scoring looks at (see scored_returns.hpp), from their own folder
/// where there is one: the same either way.
Dataset open_scored_returns(const std::filesystem::path& dataset, const ReadOptions& options,
                            const Parallel& parallel);
/// What they hit; null where neither the dataset knows nor the flight can be flown again.
std::unique_ptr<ScanTruthSource> open_scored_truth(const std::filesystem::path& dataset,
                                                   const std::string& sensor,
                                                   const Parallel& parallel);

}  // namespace lidarena
