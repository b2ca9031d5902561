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
#include "lidarena/dataset/message_stream.hpp"

/// Recordings of ROS messages: MCAP files and ROS 1 bags look the same from here.
namespace lidarena {

using StringMap = std::map<std::string, std::string>;

/// One topic of a recording (of an MCAP file: one channel).
struct RecordedTopic {
  std::string topic;
  std::string type;              ///< as ROS 2 spells it, e.g. sensor_msgs/msg/Imu
  std::string message_encoding;  ///< cdr, ros1, or another that is not read
  std::uint64_t message_count = 0;
};

/// How the messages of a topic can be decoded; empty when they cannot.
std::optional<Encoding> encoding_of(const RecordedTopic& topic);

/// What is in a recording.
struct RecordingInfo {
  std::vector<RecordedTopic> topics;
  std::uint64_t message_count = 0;
  Time start{0};  ///< earliest and latest log time; 0 without messages
  Time end{0};
  std::uint64_t chunk_count = 0;
  std::map<std::string, StringMap> metadata;  ///< records by name
  bool from_summary = false;  ///< false: there was none, so the whole file was read and verified
  std::string damage;         ///< why a reading without summary ended early; empty if it did not

  /// Messages of all channels named `topic`.
  std::uint64_t count_of(const std::string& topic) const;
};

/// A message as it lies in the file; all is valid until the next one is read.
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
  /// The next message in file order, of an encoding we know; empty at the end. Throws InputError
  /// where the file is cut off or damaged; what was given out before is sound.
  virtual std::optional<RecordedMessage> next() = 0;
};

/// Takes messages in the order they come. What is not closed stays recognizably unfinished.
class RecordingWriter {
 public:
  virtual ~RecordingWriter() = default;
  /// In which messages are to be handed over.
  virtual Encoding encoding() const = 0;
  /// `type` as ROS 2 spells it. A latched topic is given to late listeners too.
  virtual std::uint16_t add_topic(const std::string& name, std::string_view type,
                                  bool latched = false) = 0;
  /// Throws InputError when a time is negative, Error when the disk is full.
  virtual void write(std::uint16_t topic, Time log_time, Time publish_time, Bytes message) = 0;
  /// What was written so far: topics in the order of their adding, counts and times.
  virtual RecordingInfo info() const = 0;
  virtual void close() = 0;
};

enum class RecordingFormat { kMcap, kBag };

/// Whether the name ends in .mcap or .bag (a ".part" behind that does no harm).
std::optional<RecordingFormat> recording_format_of(const std::filesystem::path& file);

/// Both tell the format by the first bytes of the file. They throw InputError when it is missing or
/// is neither.
std::unique_ptr<RecordingReader> open_recording(const std::filesystem::path& file);
RecordingInfo read_recording_info(const std::filesystem::path& file);

/// Creates FILE.part. `description` is kept under `name` in RecordingInfo::metadata. With
/// `metadata_beside`, an MCAP file gets rosbag2's metadata.yaml into its folder. Throws InputError
/// when the file cannot be created.
struct RecordingOptions {
  RecordingFormat format = RecordingFormat::kMcap;
  bool metadata_beside = false;
  bool compress = false;  ///< chunks of MCAP by zstd; those of bags always are, by LZ4
  std::string name;
  StringMap description;
};
std::unique_ptr<RecordingWriter> create_recording(const std::filesystem::path& file,
                                                  const RecordingOptions& options);

}  // namespace lidarena
