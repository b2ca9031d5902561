// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string_view>

#include "lidarena/dataset/recording.hpp"

namespace lidarena {

/// Whether a file that starts with these bytes is a ROS bag, of whatever version.
bool is_bag(std::string_view beginning);

/// Reads a ROS 1 bag, version 2.0 (chunks stored, lz4 or, where the library was there at build
/// time, bz2; with or without index) from front to back, in file order, one chunk in memory. Bags
/// have no check sums but those of their compressed chunks; sizes and counts are verified.
class BagReader : public RecordingReader {
 public:
  /// Throws InputError when the file is missing, is no bag, is encrypted or of another version.
  explicit BagReader(const std::filesystem::path& file);
  ~BagReader() override;

  /// Throws InputError naming file and byte when the bag is cut off, was never closed or is
  /// damaged.
  std::optional<RecordedMessage> next() override;
  /// What was met so far.
  RecordingInfo info() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Takes the answer from the index where there is a sound one, else from reading all of the bag.
/// Throws InputError when the file is missing or is no bag.
RecordingInfo read_bag_info(const std::filesystem::path& file);

}  // namespace lidarena
