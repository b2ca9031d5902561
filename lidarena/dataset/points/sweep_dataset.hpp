// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "lidarena/base/config_json.hpp"
#include "lidarena/dataset/dataset.hpp"

/// Dataset folders with one file per sweep: names and functions shared by writer and reader.
namespace lidarena::dataset {

namespace layout {

inline constexpr const char* kTimes = "times.txt";
inline constexpr const char* kImu = "imu.txt";
inline constexpr const char* kHits = "hits";  ///< ground truth of points, a PCD per sweep

inline constexpr const char* kLabels = "labels";  ///< a class for each point, a file per sweep

/// FOLDER/ID/000012.pcd (or .ply), or for KITTI FOLDER/ID/velodyne/000012.bin.
std::filesystem::path sweep_path(const std::filesystem::path& folder, const std::string& lidar_id,
                                 DatasetFormat format, std::size_t index);
/// FOLDER/ID/hits/000012.pcd.
std::filesystem::path hits_path(const std::filesystem::path& folder, const std::string& lidar_id,
                                std::size_t index);

/// FOLDER/ID/labels/000012.label, as in SemanticKITTI.
std::filesystem::path labels_path(const std::filesystem::path& folder, const std::string& lidar_id,
                                  std::size_t index);

}  // namespace layout

/// Labels of SemanticKITTI (Behley et al., ICCV 2019) that do not depend on the world.
inline constexpr std::uint32_t kUnlabeled = 0, kOutlier = 1;

/// Writes a label per point, uint32 little endian as SemanticKITTI has them: the class in the lower
/// 16 bits, the instance in the upper. `labels` has them by PointTruth::triangle; the air and
/// ghosts are kOutlier, what it does not have is kUnlabeled.
void write_labels(const std::filesystem::path& file, const std::vector<PointTruth>& points,
                  const std::vector<std::uint32_t>& labels);

/// Ground truth of points as binary PCD: x y z range normal_x normal_y normal_z float32, triangle
/// uint32.
void write_hits(const std::filesystem::path& file, const std::vector<PointTruth>& points);
std::vector<PointTruth> read_hits(const std::filesystem::path& file);

/// Whether a manifest describes a dataset stored as sweeps.
bool is_sweep_dataset(const Json& manifest);
/// Throws InputError naming the file that is missing or broken; a missing sweep is reported by
/// next().
Dataset open_sweep_dataset(const std::filesystem::path& folder, Rig rig, Json manifest,
                           const ReadOptions& options);
/// As open_scan_truth().
std::unique_ptr<ScanTruthSource> open_sweep_truth(const std::filesystem::path& folder,
                                                  const Json& manifest, const std::string& sensor);

}  // namespace lidarena::dataset
