// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/dataset/recording_source.hpp"

#include <exception>
#include <utility>

#include "lidarena/base/error.hpp"
#include "lidarena/dataset/messages/livox_message.hpp"
#include "lidarena/dataset/messages/ros_messages.hpp"
#include "lidarena/dataset/stream_merge.hpp"

namespace lidarena::dataset {
namespace {

class RecordedEvents final : public EventSource {
 public:
  RecordedEvents(std::unique_ptr<RecordingReader> reader, std::string place,
                 RecordedSensors sensors, const std::vector<std::string>& imus)
      : place_(std::move(place)),
        reader_(std::move(reader)),
        sensors_(std::move(sensors)),
        merge_(place_, imus) {}

  std::optional<Event> next() override {
    while (true) {
      if (auto event = merge_.pop()) return event;
      if (failure_) std::rethrow_exception(failure_);
      if (finished_) return std::nullopt;
      read_next();
    }
  }

 private:
  /// Reads one message. At the end of the recording, or where it is damaged, releases the waiting
  /// scans.
  void read_next() {
    if (const auto message = next_message()) return deliver(*message);
    finished_ = true;
    merge_.finish();
  }

  std::optional<RecordedMessage> next_message() {
    try {
      return reader_->next();
    } catch (const InputError&) {
      failure_ = std::current_exception();
    }
    return std::nullopt;
  }

  void deliver(const RecordedMessage& message) {
    const std::string topic(message.topic);
    if (const auto imu = sensors_.imus.find(topic); imu != sensors_.imus.end()) {
      ImuSample sample = ros::decode_imu(message.data, place_of(topic), message.encoding);
      if (sensors_.imus_in_g.contains(imu->second)) sample.accel *= kStandardGravity;
      merge_.push({imu->second, sample});
    } else if (const auto lidar = sensors_.lidars.find(topic); lidar != sensors_.lidars.end()) {
      merge_.push({lidar->second, decode_scan(message, place_of(topic))});
    }
  }

  static Scan decode_scan(const RecordedMessage& message, const std::string& place) {
    return is_livox_type(message.type) ? decode_livox(message.data, place, message.encoding)
                                       : ros::decode_scan(message.data, place, message.encoding);
  }

  std::string place_of(const std::string& topic) const { return place_ + ": " + topic; }

  std::string place_;
  std::unique_ptr<RecordingReader> reader_;
  RecordedSensors sensors_;
  StreamMerge merge_;
  bool finished_ = false;
  std::exception_ptr failure_;
};

}  // namespace

bool is_scan_type(const RecordedTopic& topic) {
  return encoding_of(topic) && (topic.type == ros::kPointCloud2 || is_livox_type(topic.type));
}

bool is_imu_type(const RecordedTopic& topic) {
  return encoding_of(topic) && topic.type == ros::kImu;
}

std::unique_ptr<EventSource> open_recorded_events(const std::filesystem::path& file,
                                                  const RecordedSensors& sensors,
                                                  const RecordingInfo& info) {
  std::vector<std::string> imus;
  for (const auto& [topic, id] : sensors.imus) {
    if (info.count_of(topic) > 0) imus.push_back(id);
  }
  return recorded_events(open_recording(file), file.string(), sensors, imus);
}

std::unique_ptr<EventSource> recorded_events(std::unique_ptr<RecordingReader> reader,
                                             const std::string& place,
                                             const RecordedSensors& sensors,
                                             const std::vector<std::string>& imus) {
  return std::make_unique<RecordedEvents>(std::move(reader), place, sensors, imus);
}

bool is_in_g(const std::filesystem::path& file, const std::string& imu_topic) {
  constexpr int kSamples = 100;  // half a second at 200 Hz: averages out vibration
  const auto reader = open_recording(file);
  double sum = 0.0;
  int count = 0;
  try {
    while (count < kSamples) {
      const auto message = reader->next();
      if (!message) break;
      if (message->topic != imu_topic) continue;
      sum += ros::decode_imu(message->data, imu_topic, message->encoding).accel.norm();
      ++count;
    }
  } catch (const InputError&) {
    // Decide by the samples before the damage.
  }
  const double mean = count > 0 ? sum / count : 0.0;
  return mean > 0.5 && mean < 2.0;
}

}  // namespace lidarena::dataset
