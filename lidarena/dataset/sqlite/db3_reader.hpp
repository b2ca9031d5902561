// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <memory>
#include <optional>

#include "lidarena/dataset/recording.hpp"

namespace lidarena::dataset {

/// Whether the file begins as SQLite databases do.
bool is_sqlite(const std::filesystem::path& file);

/// Reads a rosbag2 file in SQLite storage (.db3): the tables `topics` (id, name, type,
/// serialization_format) and `messages` (id, topic_id, timestamp, data), in the order in which
/// messages were stored. The file is only read.
class Db3Reader final : public RecordingReader {
 public:
  /// Throws InputError when the file is no rosbag2 database, or when the build lacks SQLite;
  /// DamagedFile when its head is damaged.
  explicit Db3Reader(const std::filesystem::path& file);
  ~Db3Reader() override;
  /// Throws DamagedFile where the file is cut off or damaged.
  std::optional<RecordedMessage> next() override;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Topics, counts and times; what lies before the damage of a damaged file.
RecordingInfo read_db3_info(const std::filesystem::path& file);

}  // namespace lidarena::dataset
