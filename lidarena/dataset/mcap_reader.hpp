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
#include "lidarena/dataset/mcap_records.hpp"

namespace lidarena {

/// A message as it lies in the file; `data` and `channel` are valid until the next one is read.
struct McapMessage {
  const mcap::Channel* channel = nullptr;
  std::uint32_t sequence = 0;
  Time log_time{0};
  Time publish_time{0};
  Bytes data;
};

/// Reads any MCAP file (chunks stored, zstd or lz4; with or without summary) from front to back, in
/// file order, one chunk in memory. Every check sum there is gets verified: of each chunk before
/// its first message is given out, of the whole data section (attachments included) and of the
/// summary at the end; so is the summary's count of messages. What a chunk holds is thus given out
/// unchanged or not at all. The bytes between chunks are vouched for at the end of the data section
/// only: where damage hits those, a chunk may be missing before the error comes.
class McapReader {
 public:
  /// Throws InputError when the file is missing or is not MCAP.
  explicit McapReader(const std::filesystem::path& file);
  ~McapReader();

  /// The next message; empty once the end is reached and found whole. Throws InputError naming file
  /// and byte when the file is cut off ("is cut off after N messages") or damaged; what was given
  /// out before is sound.
  std::optional<McapMessage> next();

  const mcap::Header& header() const;
  /// What was met so far, by id.
  const std::map<std::uint16_t, mcap::Channel>& channels() const;
  const std::map<std::uint16_t, mcap::Schema>& schemas() const;
  /// Metadata records met so far, by name; a later one of the same name wins.
  const std::map<std::string, mcap::StringMap>& metadata() const;
  /// Counts and times of what was read so far (chunks, messages, metadata, attachments).
  const mcap::Statistics& statistics() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace lidarena
