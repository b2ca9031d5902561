// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <memory>
#include <string>

#include "lidarena/base/point_truth.hpp"
#include "lidarena/base/rig.hpp"

namespace lidarena::dataset {

class PartFile;

inline constexpr const char* kHitsEnding = "_hits.bin";  ///< of the files' names

/// Writes what the scored returns of each LiDAR hit, beside the measurements of a dataset:
/// SENSOR_hits.bin. No recording that a method is given contains it; the scorer reads it. Per
/// return 24 bytes: position and normal of the surface (PointTruth without range and triangle). A
/// scan with returns of movers, the air or ghosts has also 4 bytes per return:
/// PointTruth::triangle.
class HitsWriter final : public ScanTruthSink {
 public:
  /// `triangles`: number of the world's. Throws InputError when the folder is missing or read-only.
  HitsWriter(const std::filesystem::path& folder, const Rig& rig, std::size_t triangles);
  ~HitsWriter() override;

  /// `truth` has the scored returns alone. Throws Error when the disk is full.
  void write(const ScanTruth& truth) override;
  /// Completes the files, which are otherwise left with the ending .part.
  void commit();

 private:
  std::size_t triangles_;
  std::map<std::string, std::unique_ptr<PartFile>> files_;  ///< by LiDAR
};

/// Removes the hits of all sensors from a dataset folder.
void remove_hits(const std::filesystem::path& dataset);

/// Reads SENSOR_hits.bin of a dataset; null if there is none. The returned source throws InputError
/// naming the file if it is damaged.
std::unique_ptr<ScanTruthSource> open_hits(const std::filesystem::path& dataset,
                                           const std::string& sensor);

}  // namespace lidarena::dataset
