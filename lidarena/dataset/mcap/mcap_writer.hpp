// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>

#include "lidarena/base/time.hpp"
#include "lidarena/dataset/mcap/mcap_records.hpp"

namespace lidarena::dataset {

struct McapWriterOptions {
  std::string profile = "ros2";
  int zstd_level = 1;                 ///< 0 = no compression
  std::size_t chunk_bytes = 2 << 20;  ///< a chunk is closed once it reaches this size
};

/// Writes an indexed MCAP file with all checksums. Needs memory for one chunk and about 100 bytes
/// for each chunk written. Writes to NAME.part; close() completes and renames it. Without close()
/// NAME.part remains: everything up to its last chunk can be read, and the reader reports that it
/// is cut off.
class McapWriter {
 public:
  /// Throws InputError when the file cannot be created.
  explicit McapWriter(const std::filesystem::path& file, const McapWriterOptions& options = {});
  ~McapWriter();

  /// Both return an id and write nothing until a message needs them.
  std::uint16_t add_schema(const std::string& name, const std::string& encoding,
                           const std::string& text);
  std::uint16_t add_channel(const std::string& topic, std::uint16_t schema_id,
                            const std::string& message_encoding,
                            const mcap::StringMap& metadata = {});
  /// Writes the record immediately, between chunks.
  void add_metadata(const std::string& name, const mcap::StringMap& values);
  /// Messages of a channel are numbered from 0. Throws InputError when a time is negative, Error
  /// when the disk is full.
  void write(std::uint16_t channel_id, Time log_time, Time publish_time, Bytes data);
  /// Counts and times of what was written so far.
  const mcap::Statistics& statistics() const;
  /// Writes index and summary and renames NAME.part to NAME. Nothing may be written afterwards.
  void close();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace lidarena::dataset
