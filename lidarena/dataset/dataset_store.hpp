// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "lidarena/base/config_json.hpp"
#include "lidarena/base/rig.hpp"
#include "lidarena/base/trajectory.hpp"
#include "lidarena/dataset/dataset.hpp"
#include "lidarena/dataset/point_truth.hpp"

namespace lidarena {

/// Where the measurements of a dataset go: one recording, or a folder of sweeps. Sensors are those
/// of the rig; the caller has checked it.
class DatasetStore {
 public:
  virtual ~DatasetStore() = default;
  virtual void write(const std::string& imu_id, const ImuSample& sample) = 0;
  virtual void write(const std::string& lidar_id, const Scan& scan) = 0;
  virtual void write(const ScanTruth& truth) = 0;
  virtual void write_truth(const StampedPose& pose) = 0;
  /// Completes the files and returns what manifest.json is to say of them.
  virtual Json finish() = 0;
};

/// A recording `file`; with `is_folder`, metadata.yaml for `ros2 bag play` comes beside it.
std::unique_ptr<DatasetStore> make_recording_store(const std::filesystem::path& file,
                                                   const Rig& rig, const WriteOptions& options,
                                                   bool is_folder);

/// A folder of sweeps, IMU rows and times for each sensor. The folder exists.
std::unique_ptr<DatasetStore> make_sweep_store(const std::filesystem::path& folder, const Rig& rig,
                                               DatasetFormat format);

}  // namespace lidarena
