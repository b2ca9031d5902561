// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/dataset/recording_source.hpp"

#include <array>
#include <exception>
#include <utility>

#include "lidarena/base/error.hpp"
#include "lidarena/dataset/livox_message.hpp"
#include "lidarena/dataset/mcap_reader.hpp"
#include "lidarena/dataset/ros_messages.hpp"
#include "lidarena/dataset/stream_merge.hpp"

namespace lidarena {
namespace {

class McapSource final : public EventSource {
 public:
  McapSource(const std::filesystem::path& file, const McapSensors& sensors, const McapInfo& info)
      : file_(file.string()),
        reader_(file),
        sensors_(sensors),
        merge_(file_, imus_with_samples(sensors, info)) {}

  std::optional<Event> next() override {
    while (true) {
      if (auto event = merge_.pop()) return event;
      if (failure_) std::rethrow_exception(failure_);
      if (finished_) return std::nullopt;
      read_on();
    }
  }

 private:
  static std::vector<std::string> imus_with_samples(const McapSensors& sensors,
                                                    const McapInfo& info) {
    std::vector<std::string> ids;
    for (const auto& [topic, id] : sensors.imus) {
      if (info.count_of(topic) > 0) ids.push_back(id);
    }
    return ids;
  }

  /// Takes one message. At the end, and where the file breaks off, the scans that wait come first.
  void read_on() {
    if (const auto message = next_message()) return deliver(*message);
    finished_ = true;
    merge_.finish();
  }

  std::optional<McapMessage> next_message() {
    try {
      return reader_.next();
    } catch (const InputError&) {
      failure_ = std::current_exception();
    }
    return std::nullopt;
  }

  void deliver(const McapMessage& message) {
    const std::string& topic = message.channel->topic;
    if (const auto imu = sensors_.imus.find(topic); imu != sensors_.imus.end()) {
      merge_.push({imu->second, ros::decode_imu(message.data, place_of(topic))});
    } else if (const auto lidar = sensors_.lidars.find(topic); lidar != sensors_.lidars.end()) {
      merge_.push({lidar->second, decode_scan(message)});
    }
  }

  Scan decode_scan(const McapMessage& message) const {
    const std::string place = place_of(message.channel->topic);
    const auto schema = reader_.schemas().find(message.channel->schema_id);
    const bool is_livox = schema != reader_.schemas().end() && is_livox_type(schema->second.name);
    return is_livox ? decode_livox(message.data, place) : ros::decode_scan(message.data, place);
  }

  std::string place_of(const std::string& topic) const { return file_ + ": " + topic; }

  std::string file_;
  McapReader reader_;
  McapSensors sensors_;
  StreamMerge merge_;
  bool finished_ = false;
  std::exception_ptr failure_;
};

}  // namespace

bool is_scan_type(const McapTopic& topic) {
  return topic.message_encoding == "cdr" &&
         (topic.type == ros::kPointCloud2 || is_livox_type(topic.type));
}

bool is_imu_type(const McapTopic& topic) {
  return topic.message_encoding == "cdr" && topic.type == ros::kImu;
}

std::unique_ptr<EventSource> open_mcap_events(const std::filesystem::path& file,
                                              const McapSensors& sensors, const McapInfo& info) {
  return std::make_unique<McapSource>(file, sensors, info);
}

}  // namespace lidarena
