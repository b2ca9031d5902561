// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "lidarena/base/config_json.hpp"
#include "lidarena/base/log.hpp"
#include "lidarena/base/parallel.hpp"
#include "lidarena/dataset/dataset.hpp"
#include "lidarena/sensor/sensor_config.hpp"

namespace lidarena::dataset {
class RecordingWriter;
}

namespace lidarena::stages {

/// Input of `lidarena simulate`, with names resolved to files.
struct SimulateRequest {
  std::filesystem::path world;
  std::filesystem::path flight;
  std::vector<std::filesystem::path> sensors;
  std::filesystem::path shipped_sensors{};  ///< where files name their base, see load_sensor()
  std::vector<std::string> set{};           ///< "KIND.key=value", see scene_settings()
  std::uint64_t seed = 1;                   ///< of all noise
  /// The seed also draws a procedural world, start and direction of its routes, and the gusts,
  /// whose files have seeds of their own otherwise.
  bool new_scene = false;
  double seconds = 0.0;        ///< 0 = the whole flight
  bool allow_missing = false;  ///< load an SDF world without models and meshes that are missing
  bool noise = true;
  std::optional<sensor::ScanMode> mode;  ///< of all sensors; empty = as in their files
  bool data = true;                      ///< false: a manifest only; simulated whenever it is read
  bool truth = false;                    ///< also write what each point hit, as /truth/SENSOR/hits
  /// Write what the scored returns hit, SENSOR_hits.bin; empty: if the measurements are written.
  std::optional<bool> hits{};
  dataset::WriteOptions write;  ///< format and dialect of the measurements
  /// If given, gets the messages that data.mcap would hold, while they are simulated; the dataset
  /// is then written as if `data` was false, before the first of them.
  std::shared_ptr<dataset::RecordingWriter> live{};
  std::function<bool()> stopped{};  ///< with `live`: asked often; true ends the flight
};

/// Counts and sizes of what was simulated.
struct SimulateSummary {
  std::size_t triangles = 0;
  std::size_t scans = 0;
  std::size_t points = 0;
  std::size_t imu_samples = 0;
  double seconds = 0.0;  ///< of flight
  double path_m = 0.0;   ///< length of the flown path
};

/// Simulates the flight and writes the dataset folder `out`: world.ply, truth.tum (1 kHz),
/// data.mcap (or the format of `write`) if `data` is set, the hits that scoring needs, and
/// manifest.json last.
SimulateSummary simulate_dataset(const SimulateRequest& request, const std::filesystem::path& out,
                                 const Parallel& parallel, LogSink& log);

/// Like open_dataset(), but also opens datasets without measurements: these are simulated while
/// they are read, with the same points as if they had been written.
dataset::Dataset open_any_dataset(const std::filesystem::path& path,
                                  const dataset::ReadOptions& options, const Parallel& parallel);

/// The truth of the points of the LiDAR `sensor` of a dataset without measurements, simulated while
/// it is read; null for any other dataset.
std::unique_ptr<ScanTruthSource> open_simulated_truth(const std::filesystem::path& dataset,
                                                      const std::string& sensor,
                                                      const Parallel& parallel);

/// See semantic_labels(); empty for a dataset that was not simulated, or whose mesh is not there.
std::vector<std::uint32_t> labels_of_dataset(const std::filesystem::path& dataset);

}  // namespace lidarena::stages
