// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "lidarena/base/time.hpp"
#include "lidarena/dataset/mcap/mcap_records.hpp"

namespace lidarena::dataset {

/// A message as stored in the file; `data` and `channel` are valid until the next one is read.
struct McapMessage {
  const mcap::Channel* channel = nullptr;
  std::uint32_t sequence = 0;
  Time log_time{0};
  Time publish_time{0};
  Bytes data;
};

/// Reads any MCAP file (chunks uncompressed, zstd or lz4; with or without summary) from front to
/// back, in file order, with one chunk in memory. Verifies every checksum in the file: of each
/// chunk before its first message is returned, of the whole data section (attachments included) and
/// of the summary at the end; also the message count of the summary. Messages of a chunk are thus
/// returned unchanged or not at all. The bytes between chunks are covered only by the checksum at
/// the end of the data section: if they are damaged, a chunk may be missing before the error is
/// thrown.
class McapReader {
 public:
  /// Throws InputError when the file is missing or is not MCAP.
  explicit McapReader(const std::filesystem::path& file);
  ~McapReader();

  /// The next message; empty at the end of a complete file. Throws InputError naming file and byte
  /// when the file is cut off ("is cut off after N messages") or damaged; the messages returned
  /// before are intact.
  std::optional<McapMessage> next();

  const mcap::Header& header() const;
  /// Channels and schemas read so far, by id.
  const std::map<std::uint16_t, mcap::Channel>& channels() const;
  const std::map<std::uint16_t, mcap::Schema>& schemas() const;
  /// Metadata records read so far, by name; a later one replaces an earlier one of the same name.
  const std::map<std::string, mcap::StringMap>& metadata() const;
  /// Counts and times of what was read so far (chunks, messages, metadata, attachments).
  const mcap::Statistics& statistics() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace lidarena::dataset
