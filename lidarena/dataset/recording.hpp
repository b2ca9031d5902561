// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "lidarena/base/time.hpp"
#include "lidarena/dataset/messages/message_stream.hpp"

/// Recordings of ROS messages: one interface to MCAP files, ROS 1 bags and bags of rosbag2.
namespace lidarena::dataset {

using StringMap = std::map<std::string, std::string>;

/// One topic of a recording (of an MCAP file: one channel).
struct RecordedTopic {
  std::string topic;
  std::string type;              ///< as ROS 2 spells it, e.g. sensor_msgs/msg/Imu
  std::string message_encoding;  ///< cdr, ros1, or another, which is not supported
  std::uint64_t message_count = 0;
};

/// How the messages of a topic can be decoded; empty when they cannot.
std::optional<Encoding> encoding_of(const RecordedTopic& topic);

/// Contents of a recording.
struct RecordingInfo {
  std::vector<RecordedTopic> topics;
  std::uint64_t message_count = 0;
  Time start{0};  ///< earliest and latest log time; 0 without messages
  Time end{0};
  std::uint64_t chunk_count = 0;
  std::map<std::string, StringMap> metadata;  ///< records by name
  bool from_summary = false;  ///< false: no valid summary; whole file read and verified
  std::string damage;         ///< why reading the whole file ended early; empty if it did not

  /// Number of messages of all channels named `topic`.
  std::uint64_t count_of(const std::string& topic) const;
};

/// A message as stored in the file; valid until the next one is read.
struct RecordedMessage {
  std::string_view topic;
  std::string_view type;  ///< as ROS 2 spells it
  Encoding encoding = Encoding::kCdr;
  Time log_time{0};
  Bytes data;
};

class RecordingReader {
 public:
  virtual ~RecordingReader() = default;
  /// The next message in file order with a supported encoding; empty at the end. Throws InputError
  /// where the file is cut off or damaged; the messages returned before are intact.
  virtual std::optional<RecordedMessage> next() = 0;
};

/// Writes messages in the given order. Without close() the file stays recognizable as unfinished.
class RecordingWriter {
 public:
  virtual ~RecordingWriter() = default;
  /// Encoding of the messages to pass to write().
  virtual Encoding encoding() const = 0;
  /// `type` as ROS 2 spells it. Messages of a latched topic also reach subscribers that connect
  /// later.
  virtual std::uint16_t add_topic(const std::string& name, std::string_view type,
                                  bool latched = false) = 0;
  /// Throws InputError when a time is negative, Error when the disk is full.
  virtual void write(std::uint16_t topic, Time log_time, Time publish_time, Bytes message) = 0;
  /// What was written so far: topics in the order in which they were added, counts and times.
  virtual RecordingInfo info() const = 0;
  virtual void close() = 0;
};

enum class RecordingFormat { kMcap, kBag };

/// The format by the ending of the name, .mcap or .bag (a further ".part" or ".active" is ignored);
/// empty for others.
std::optional<RecordingFormat> recording_format_of(const std::filesystem::path& file);

/// `path` is an MCAP file, a ROS 1 bag, a .db3 of rosbag2, told apart by their first bytes, or a
/// folder with such files: the parts of one take. Both throw InputError when the file is missing or
/// has none of these formats.
std::unique_ptr<RecordingReader> open_recording(const std::filesystem::path& path);
RecordingInfo read_recording_info(const std::filesystem::path& path);

/// Options of create_recording(). The description is found again in RecordingInfo::metadata, under
/// `name`.
struct RecordingOptions {
  RecordingFormat format = RecordingFormat::kMcap;
  bool write_metadata_file = false;  ///< MCAP: write rosbag2's metadata.yaml to the file's folder
  bool compress = false;  ///< MCAP chunks, by zstd; bag chunks are always compressed, by LZ4
  std::string name;
  StringMap description;
};
/// Creates FILE.part, renamed by close(). Throws InputError when it cannot be created.
std::unique_ptr<RecordingWriter> create_recording(const std::filesystem::path& file,
                                                  const RecordingOptions& options);

}  // namespace lidarena::dataset
