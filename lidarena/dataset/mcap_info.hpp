// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "lidarena/base/time.hpp"
#include "lidarena/dataset/mcap_records.hpp"

namespace lidarena {

/// One channel of a file.
struct McapTopic {
  std::string topic;
  std::string type;              ///< name of the schema, e.g. sensor_msgs/msg/Imu
  std::string message_encoding;  ///< e.g. cdr
  std::uint64_t message_count = 0;
};

/// What is in a file.
struct McapInfo {
  mcap::Header header;
  std::vector<McapTopic> topics;  ///< in the order of their channel ids
  std::uint64_t message_count = 0;
  Time start{0};  ///< earliest and latest log time; 0 without messages
  Time end{0};
  std::uint64_t chunk_count = 0;
  std::map<std::string, mcap::StringMap> metadata;
  bool from_summary = false;  ///< false: there was none, so the whole file was read and verified
  std::string damage;         ///< why a reading without summary ended early; empty if it did not

  /// Messages of the channels named `topic`.
  std::uint64_t count_of(const std::string& topic) const;
};

/// Takes the answer from the summary where there is a sound one (a few reads, any file size), else
/// from reading all of the file. Throws InputError when the file is missing or is not MCAP.
McapInfo read_mcap_info(const std::filesystem::path& file);

}  // namespace lidarena
