// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "lidarena/base/config_json.hpp"
#include "lidarena/base/rig.hpp"
#include "lidarena/base/trajectory.hpp"
#include "lidarena/dataset/event.hpp"

namespace lidarena {

/// How to read folders of raw sweeps whose layout no file states.
struct ReadOptions {
  std::string sensor;  ///< id of the one LiDAR wanted; empty = all
  std::string layout;  ///< of raw float32 binaries: xyz, xyzi, xyzt, xyztr; empty = must be clear
  std::optional<Pose> body_from_lidar;  ///< overrides what the dataset says
  double rate_hz = 10.0;                ///< sweeps per second where the folder gives no times
};

/// An opened dataset: what an estimator may see. The truth is apart, see load_truth().
struct Dataset {
  std::filesystem::path path;
  Rig rig;
  std::optional<std::size_t> scan_count;  ///< of the chosen sensor, where known beforehand
  Json manifest;                          ///< manifest.json of the folder; null for foreign data
  std::vector<std::string> notes;         ///< what was inferred, not stated: to be shown
  std::unique_ptr<EventSource> events;
};

/// Opens a dataset folder of ours, a single .mcap, a folder of PCD/PLY/bin sweeps, or a folder in
/// the room format. Throws InputError naming file, place and remedy.
Dataset open_dataset(const std::filesystem::path& path, const ReadOptions& options = {});

/// True motion of the body where the dataset carries one (truth.tum, or gt.tum of the room format).
/// For evaluation; nothing that estimates may call it.
std::optional<Trajectory> load_truth(const std::filesystem::path& dataset);

/// The world's mesh beside the dataset (world.ply), if there.
std::optional<std::filesystem::path> find_world_mesh(const std::filesystem::path& dataset);

/// Writes a dataset folder: data.mcap, truth.tum, world.ply (by the caller), manifest.json,
/// metadata.yaml. Files appear under their names only once complete.
class DatasetWriter : public EventSink {
 public:
  DatasetWriter(const std::filesystem::path& folder, const Rig& rig);
  ~DatasetWriter() override;
  void write(const Event& event) override;
  /// True body pose, at the full rate; also written as /truth/odometry and /tf.
  void write_truth(const StampedPose& pose);
  /// Completes all files; `manifest` becomes manifest.json, last.
  void finish(const Json& manifest);
  void close() override;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace lidarena
