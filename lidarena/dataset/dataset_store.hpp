// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "lidarena/base/config_json.hpp"
#include "lidarena/base/point_truth.hpp"
#include "lidarena/base/rig.hpp"
#include "lidarena/base/trajectory.hpp"
#include "lidarena/dataset/dataset.hpp"

namespace lidarena::dataset {

/// Stores the measurements of a dataset, in one recording or in a folder of sweeps. The caller
/// makes sure that all sensors are in the rig.
class DatasetStore {
 public:
  virtual ~DatasetStore() = default;
  virtual void write(const std::string& imu_id, const ImuSample& sample) = 0;
  virtual void write(const std::string& lidar_id, const Scan& scan) = 0;
  virtual void write(const ScanTruth& truth) = 0;
  virtual void write_truth(const StampedPose& pose) = 0;
  /// Completes the files and returns the keys of manifest.json that describe them.
  virtual Json finish() = 0;
};

/// Stores to the recording `file`; with `is_folder`, also writes metadata.yaml next to it, for
/// `ros2 bag play`.
std::unique_ptr<DatasetStore> make_recording_store(const std::filesystem::path& file,
                                                   const Rig& rig, const WriteOptions& options,
                                                   bool is_folder);

class RecordingWriter;
/// Gives `out` what would be stored in a recording of `rig`, message by message.
std::unique_ptr<DatasetStore> make_message_store(std::shared_ptr<RecordingWriter> out,
                                                 const Rig& rig, const WriteOptions& options);

/// Stores sweeps, times and IMU rows, one subfolder per sensor. `folder` must exist.
std::unique_ptr<DatasetStore> make_sweep_store(const std::filesystem::path& folder, const Rig& rig,
                                               const WriteOptions& options);

}  // namespace lidarena::dataset
