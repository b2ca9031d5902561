// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/dataset/recording.hpp"

#include <algorithm>
#include <fstream>
#include <utility>

#include "lidarena/base/config_json.hpp"
#include "lidarena/base/error.hpp"
#include "lidarena/dataset/compression.hpp"
#include "lidarena/dataset/damaged_file.hpp"
#include "lidarena/dataset/mcap/mcap_info.hpp"
#include "lidarena/dataset/mcap/mcap_reader.hpp"
#include "lidarena/dataset/mcap/mcap_writer.hpp"
#include "lidarena/dataset/mcap/rosbag2_metadata.hpp"
#include "lidarena/dataset/messages/ros_messages.hpp"
#include "lidarena/dataset/part_file.hpp"
#include "lidarena/dataset/recording_parts.hpp"
#include "lidarena/dataset/ros1/bag_reader.hpp"
#include "lidarena/dataset/ros1/bag_writer.hpp"
#include "lidarena/dataset/sqlite/db3_reader.hpp"

namespace lidarena::dataset {
namespace {

namespace fs = std::filesystem;

constexpr const char* kMetadataFile = "metadata.yaml";
/// End of the topic on which a bag, which has no metadata records, holds them as a string message.
constexpr std::string_view kDescriptionEnding = "/description";

bool is_bag_by_content(const fs::path& file) {
  std::string beginning(9, '\0');
  std::ifstream(file, std::ios::binary).read(beginning.data(), 9);
  const bool named_bag = recording_format_of(file) == RecordingFormat::kBag;
  return is_bag(beginning) || (named_bag && beginning[0] != '\x89');
}

std::optional<Encoding> encoding_named(std::string_view name) {
  if (name == "cdr") return Encoding::kCdr;
  if (name == "ros1") return Encoding::kRos1;
  return std::nullopt;
}

class McapRecordingReader final : public RecordingReader {
 public:
  explicit McapRecordingReader(const fs::path& file) : reader_(file) {}

  std::optional<RecordedMessage> next() override {
    while (const auto message = reader_.next()) {
      const mcap::Channel& channel = *message->channel;
      const auto encoding = encoding_named(channel.message_encoding);
      const auto schema = reader_.schemas().find(channel.schema_id);
      if (!encoding || schema == reader_.schemas().end()) continue;
      type_ = ros::ros2_name(schema->second.name);
      return RecordedMessage{channel.topic, type_, *encoding, message->log_time, message->data};
    }
    return std::nullopt;
  }

 private:
  McapReader reader_;
  std::string type_;
};

/// Decompresses messages that rosbag2 compressed one by one (compression mode MESSAGE).
class UnpackedMessages final : public RecordingReader {
 public:
  explicit UnpackedMessages(std::unique_ptr<RecordingReader> reader) : reader_(std::move(reader)) {}

  std::optional<RecordedMessage> next() override {
    auto message = reader_->next();
    if (!message || !is_zstd(message->data)) return message;
    try {
      decompress_zstd_frame(message->data, unpacked_);
    } catch (const std::runtime_error& error) {
      throw DamagedFile(message->topic, error.what(), "copy the file again");
    }
    message->data = unpacked_;
    return message;
  }

 private:
  std::unique_ptr<RecordingReader> reader_;
  std::vector<std::byte> unpacked_;
};

class McapRecordingWriter final : public RecordingWriter {
 public:
  McapRecordingWriter(const fs::path& file, const RecordingOptions& options)
      : file_(file),
        write_metadata_file_(options.write_metadata_file),
        mcap_(file, {.zstd_level = options.compress ? 1 : 0}) {
    if (!options.name.empty()) mcap_.add_metadata(options.name, options.description);
  }

  Encoding encoding() const override { return Encoding::kCdr; }

  std::uint16_t add_topic(const std::string& name, std::string_view type, bool latched) override {
    const std::string qos = latched ? latched_qos() : default_qos();
    std::uint16_t& schema = schemas_[std::string(type)];
    if (schema == 0) {
      schema = mcap_.add_schema(std::string(type), "ros2msg", ros::definition_of(type));
    }
    topics_.push_back({name, std::string(type), qos});
    return mcap_.add_channel(name, schema, "cdr", {{"offered_qos_profiles", qos}});
  }

  void write(std::uint16_t topic, Time log_time, Time publish_time, Bytes message) override {
    mcap_.write(topic, log_time, publish_time, message);
  }

  RecordingInfo info() const override {
    const mcap::Statistics& statistics = mcap_.statistics();
    RecordingInfo info;
    for (std::size_t i = 0; i < topics_.size(); ++i) {
      info.topics.push_back(
          {topics_[i].name, topics_[i].type, "cdr",
           statistics.channel_message_counts.at(static_cast<std::uint16_t>(i + 1))});
    }
    info.message_count = statistics.message_count;
    info.start = Time{static_cast<std::int64_t>(statistics.message_start_time)};
    info.end = Time{static_cast<std::int64_t>(statistics.message_end_time)};
    info.chunk_count = statistics.chunk_count;
    return info;
  }

  /// Writes rosbag2's metadata twice, as rosbag2 does: next to the file and in it. Without the
  /// latter, newer versions misread the QoS.
  void close() override {
    const RecordingInfo written = info();
    for (std::size_t i = 0; i < topics_.size(); ++i) {
      topics_[i].message_count = written.topics[i].message_count;
    }
    const std::string yaml =
        rosbag2_metadata(file_.filename().string(), topics_, written.start, written.end);
    mcap_.add_metadata("rosbag2", {{"serialized_metadata", yaml}});
    if (write_metadata_file_) write_text_file(file_.parent_path() / kMetadataFile, yaml);
    mcap_.close();
  }

 private:
  fs::path file_;
  bool write_metadata_file_;
  McapWriter mcap_;
  std::map<std::string, std::uint16_t> schemas_;
  std::vector<RosbagTopic> topics_;  ///< at index channel id - 1
};

/// Writes a bag whose first message holds the description of RecordingOptions.
class BagRecordingWriter final : public RecordingWriter {
 public:
  BagRecordingWriter(const fs::path& file, const RecordingOptions& options)
      : bag_(file), description_(Json(options.description).dump()) {
    if (options.name.empty()) return;
    topic_ =
        bag_.add_topic("/" + options.name + std::string(kDescriptionEnding), ros::kString, true);
  }

  Encoding encoding() const override { return bag_.encoding(); }
  std::uint16_t add_topic(const std::string& name, std::string_view type, bool latched) override {
    return bag_.add_topic(name, type, latched);
  }
  void write(std::uint16_t topic, Time log_time, Time publish_time, Bytes message) override {
    describe(log_time);
    bag_.write(topic, log_time, publish_time, message);
  }
  RecordingInfo info() const override { return bag_.info(); }
  void close() override {
    describe(Time{0});
    bag_.close();
  }

 private:
  void describe(Time time) {
    if (!topic_) return;
    MessageWriter message(bag_.encoding());
    ros::encode_string(description_, message);
    bag_.write(*std::exchange(topic_, std::nullopt), time, time, message.bytes());
  }

  BagWriter bag_;
  std::string description_;
  std::optional<std::uint16_t> topic_;  ///< of the description, until it is written
};

/// Reads the descriptions among the messages of a bag, on topics /NAME/description.
void add_metadata(const fs::path& file, RecordingInfo& info) {
  const auto is_description = [](std::string_view topic, std::string_view type) {
    return type == ros::kString && topic.starts_with('/') && topic.ends_with(kDescriptionEnding);
  };
  auto left = std::ranges::count_if(info.topics, [&](const RecordedTopic& topic) {
    return topic.message_count > 0 && is_description(topic.topic, topic.type);
  });
  if (left == 0) return;
  BagReader reader(file);
  while (left > 0) {
    const auto message = reader.next();
    if (!message) return;
    if (!is_description(message->topic, message->type)) continue;
    --left;
    const std::string text = ros::decode_string(message->data, file.string(), message->encoding);
    const Json json = Json::parse(text, nullptr, false);
    if (!json.is_object()) continue;
    const std::string name(
        message->topic.substr(1, message->topic.size() - 1 - kDescriptionEnding.size()));
    for (const auto& [key, value] : json.items()) {
      if (value.is_string()) info.metadata[name][key] = value.get<std::string>();
    }
  }
}

}  // namespace

std::optional<Encoding> encoding_of(const RecordedTopic& topic) {
  return encoding_named(topic.message_encoding);
}

std::uint64_t RecordingInfo::count_of(const std::string& topic) const {
  std::uint64_t count = 0;
  for (const RecordedTopic& entry : topics) {
    count += entry.topic == topic ? entry.message_count : 0;
  }
  return count;
}

std::optional<RecordingFormat> recording_format_of(const fs::path& file) {
  const bool is_open = file.extension() == ".part" || file.extension() == ".active";
  const fs::path whole = is_open ? file.stem() : file.filename();
  if (whole.extension() == ".mcap") return RecordingFormat::kMcap;
  if (whole.extension() == ".bag") return RecordingFormat::kBag;
  return std::nullopt;
}

std::unique_ptr<RecordingReader> open_recording(const fs::path& path) {
  if (fs::is_directory(path)) return open_parts(recordings_in(path));
  if (is_sqlite(path)) return std::make_unique<UnpackedMessages>(std::make_unique<Db3Reader>(path));
  if (is_bag_by_content(path)) return std::make_unique<BagReader>(path);
  return std::make_unique<UnpackedMessages>(std::make_unique<McapRecordingReader>(path));
}

RecordingInfo read_recording_info(const fs::path& path) {
  if (fs::is_directory(path)) return read_parts_info(recordings_in(path));
  if (is_sqlite(path)) return read_db3_info(path);
  if (!is_bag_by_content(path)) return read_mcap_info(path);
  RecordingInfo info = read_bag_info(path);
  add_metadata(path, info);
  return info;
}

std::unique_ptr<RecordingWriter> create_recording(const fs::path& file,
                                                  const RecordingOptions& options) {
  if (options.format == RecordingFormat::kBag) {
    return std::make_unique<BagRecordingWriter>(file, options);
  }
  return std::make_unique<McapRecordingWriter>(file, options);
}

}  // namespace lidarena::dataset
