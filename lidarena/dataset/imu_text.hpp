// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <vector>

#include "lidarena/base/imu_sample.hpp"
#include "lidarena/dataset/part_file.hpp"

namespace lidarena::dataset {

/// Reads rows t wx wy wz ax ay az (s, rad/s, m/s^2) with strictly increasing times. Throws
/// InputError naming file and line.
std::vector<ImuSample> read_imu_text(const std::filesystem::path& file);

/// Writes such rows; reading them back gives exactly the same numbers.
class ImuTextWriter {
 public:
  explicit ImuTextWriter(const std::filesystem::path& file);
  void write(const ImuSample& sample);
  void close() { out_.commit(); }

 private:
  PartFile out_;
};

}  // namespace lidarena::dataset
