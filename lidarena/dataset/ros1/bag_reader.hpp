// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string_view>

#include "lidarena/dataset/recording.hpp"

namespace lidarena::dataset {

/// Whether a file that starts with these bytes is a ROS bag, of any version.
bool is_bag(std::string_view beginning);

/// Reads a ROS 1 bag, version 2.0 (chunks uncompressed, lz4 or, if built with libbz2, bz2; with or
/// without index) from front to back, in file order, with one chunk in memory. Bags have no
/// checksums except inside compressed chunks; sizes and counts are verified.
class BagReader : public RecordingReader {
 public:
  /// Throws InputError when the file is missing, is not a bag, is encrypted or of another version.
  explicit BagReader(const std::filesystem::path& file);
  ~BagReader() override;

  /// Throws InputError naming file and byte when the bag is cut off, was never closed or is
  /// damaged.
  std::optional<RecordedMessage> next() override;
  /// Topics, counts and times read so far.
  RecordingInfo info() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Reads only the index if the bag has a valid one, else the whole bag. Throws InputError when the
/// file is missing or is not a bag.
RecordingInfo read_bag_info(const std::filesystem::path& file);

}  // namespace lidarena::dataset
