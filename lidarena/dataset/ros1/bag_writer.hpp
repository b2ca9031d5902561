// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>

#include "lidarena/base/time.hpp"
#include "lidarena/dataset/byte_stream.hpp"
#include "lidarena/dataset/recording.hpp"

namespace lidarena::dataset {

enum class BagCompression { kNone, kLz4 };

struct BagWriterOptions {
  BagCompression compression = BagCompression::kLz4;
  std::size_t chunk_bytes = 768 * 1024;  ///< a chunk is closed once it reaches this size
};

/// Writes an indexed ROS 1 bag, version 2.0. Needs memory for one chunk and about 100 bytes for
/// each chunk written. Writes to NAME.part; close() completes and renames it. Without close()
/// NAME.part remains, without an index: everything up to its last chunk can be read.
class BagWriter : public RecordingWriter {
 public:
  /// Throws InputError when the file cannot be created.
  explicit BagWriter(const std::filesystem::path& file, const BagWriterOptions& options = {});
  ~BagWriter() override;

  Encoding encoding() const override { return Encoding::kRos1; }
  /// `type` is one of those in ros_messages.hpp.
  std::uint16_t add_topic(const std::string& name, std::string_view type,
                          bool latched = false) override;
  /// Bags store only the log time. Throws InputError when it is negative or after the year 2106.
  void write(std::uint16_t topic, Time log_time, Time publish_time, Bytes message) override;
  RecordingInfo info() const override;
  void close() override;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace lidarena::dataset
