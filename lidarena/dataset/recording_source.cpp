// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/dataset/recording_source.hpp"

#include <fmt/format.h>

#include <exception>
#include <optional>
#include <utility>

#include "lidarena/base/error.hpp"
#include "lidarena/dataset/damaged_file.hpp"
#include "lidarena/dataset/log_order.hpp"
#include "lidarena/dataset/messages/livox_message.hpp"
#include "lidarena/dataset/messages/point_cloud2.hpp"
#include "lidarena/dataset/messages/ros_messages.hpp"
#include "lidarena/dataset/packets/velodyne_packets.hpp"
#include "lidarena/dataset/stream_merge.hpp"
#include "lidarena/dataset/text_file.hpp"

namespace lidarena::dataset {
namespace {

constexpr Time kMaxMissing = std::chrono::milliseconds(500);  // of an IMU at the end, unmentioned
constexpr Time kLookAhead = std::chrono::milliseconds(300);   // some sweeps

/// Decodes the messages of the sensors.
class Decoder {
 public:
  Decoder(std::string place, const RecordedSensors& sensors, ReadReport& report)
      : place_(std::move(place)), sensors_(sensors), report_(report) {}

  bool is_imu(std::string_view topic) const { return sensors_.imus.contains(std::string(topic)); }

  /// Empty for messages of other topics, and for samples that are left out.
  std::optional<Event> decode(const RecordedMessage& message) {
    const std::string topic(message.topic);
    if (const auto imu = sensors_.imus.find(topic); imu != sensors_.imus.end()) {
      if (auto sample = decode_sample(message, topic, imu->second))
        return Event{imu->second, *sample};
    } else if (const auto lidar = sensors_.lidars.find(topic); lidar != sensors_.lidars.end()) {
      return Event{lidar->second, decode_scan(message, topic)};
    }
    return std::nullopt;
  }

 private:
  std::optional<ImuSample> decode_sample(const RecordedMessage& message, const std::string& topic,
                                         const std::string& id) {
    ImuSample sample = ros::decode_imu(message.data, place_of(topic), message.encoding);
    if (const auto units = sensors_.imu_units.find(id); units != sensors_.imu_units.end()) {
      sample.accel *= units->second.accel;
      sample.gyro *= units->second.gyro;
    }
    const std::string_view fault = fault_of(sample);
    if (fault.empty()) return sample;
    report_.count(fmt::format("{}: IMU sample {}, left out", topic, fault), sample.stamp);
    return std::nullopt;
  }

  Scan decode_scan(const RecordedMessage& message, const std::string& topic) {
    const std::string place = place_of(topic);
    if (is_livox_type(message.type)) return decode_livox(message.data, place, message.encoding);
    if (is_velodyne_type(message.type))
      return decode_velodyne(message.data, place, message.encoding);
    const auto rule = sensors_.point_times.find(topic);
    if (rule == sensors_.point_times.end())
      return ros::decode_scan(message.data, place, message.encoding);
    MessageReader in(message.data, place, message.encoding);
    const ros::MessageHeader header = ros::get_header(in);
    ros::TimeFaults faults;
    Scan scan =
        ros::scan_from_cloud(header.stamp, ros::get_cloud(in, place), place, rule->second, faults);
    if (faults.implausible) {
      report_.count(fmt::format("{}: sweep with implausible times of its points (field '{}'), not "
                                "de-skewed by time",
                                topic, rule->second.field),
                    header.stamp);
    }
    if (faults.undated_points > 0) {
      report_.count(fmt::format("{}: sweep with points whose '{}' is not finite, left out", topic,
                                rule->second.field),
                    header.stamp);
    }
    return scan;
  }

  std::string place_of(const std::string& topic) const { return place_ + ": " + topic; }

  std::string place_;
  const RecordedSensors& sensors_;
  ReadReport& report_;
};

class RecordedEvents final : public EventSource {
 public:
  RecordedEvents(const std::filesystem::path& file, RecordedSensors sensors,
                 const std::vector<std::string>& imus, std::shared_ptr<ReadReport> report)
      : file_(file),
        sensors_(std::move(sensors)),
        report_(std::move(report)),
        decoder_(file.string(), sensors_, *report_),
        reader_(open_recording(file)),
        order_(sensors_.point_times.empty() ? Time{0} : kLookAhead),
        merge_(file.string(), imus, report_.get()),
        imus_(imus) {}

  std::optional<Event> next() override {
    while (true) {
      if (auto event = merge_.pop()) return event;
      if (!finished_) {
        read_next();
      } else if (failure_) {
        std::rethrow_exception(failure_);
      } else {
        return std::nullopt;
      }
    }
  }

 private:
  /// Reads one message. At the end of the recording, or where it is damaged, releases the waiting
  /// scans.
  void read_next() {
    if (merge_.lagging() && !imu_reader_) imu_reader_ = open_recording(file_);
    if (imu_reader_ && merge_.is_waiting() && !imus_.empty()) return read_imu_ahead();
    if (const auto message = next_message()) {
      if (imu_reader_ && decoder_.is_imu(message->topic)) return;
      if (auto event = decoder_.decode(*message)) order_.push(message->log_time, *std::move(event));
    } else {
      order_.finish();
    }
    while (auto event = order_.pop()) merge_.push(*std::move(event));
    if (!ended_) return;
    if (imu_reader_ && !imus_.empty()) return read_imu_ahead();  // samples after the last scan
    if (const auto imu = merge_.lagging(kMaxMissing)) give_up(*imu);
    finished_ = true;
    merge_.finish();
  }

  /// Reads the next IMU sample, of a file in which the scans come long before them. Those that were
  /// already delivered are skipped.
  void read_imu_ahead() {
    try {
      while (const auto message = imu_reader_->next()) {
        if (!decoder_.is_imu(message->topic)) continue;
        if (auto event = decoder_.decode(*message)) return push_ahead(*std::move(event));
      }
    } catch (const DamagedFile&) {
      // The main reader comes to the same place and reports it.
    }
    if (const auto imu = merge_.lagging(kMaxMissing)) give_up(*imu);
    for (const std::string& imu : imus_) merge_.give_up(imu);
    imus_.clear();
  }

  void push_ahead(Event event) {
    const Time stamp = std::get<ImuSample>(event.data).stamp;
    if (stamp <= merge_.latest_imu(event.sensor_id)) return;
    merge_.push(std::move(event));
  }

  void give_up(const std::string& imu) {
    const Time until = merge_.give_up(imu);
    if (until == Time::min())
      return report_->count(fmt::format("'{}': the IMU has no sample that can be used", imu),
                            Time{0});
    report_->count(
        fmt::format("'{}': the IMU has no sample from here to the end of the scans", imu), until);
  }

  std::optional<RecordedMessage> next_message() {
    try {
      if (ended_) return std::nullopt;
      if (auto message = reader_->next()) return message;
    } catch (const DamagedFile&) {
      failure_ = std::current_exception();
    }
    ended_ = true;
    return std::nullopt;
  }

  std::filesystem::path file_;
  RecordedSensors sensors_;
  std::shared_ptr<ReadReport> report_;
  Decoder decoder_;
  std::unique_ptr<RecordingReader> reader_;
  std::unique_ptr<RecordingReader> imu_reader_;  ///< opened where the IMU lags behind the scans
  LogOrder order_;
  StreamMerge merge_;
  std::vector<std::string> imus_;  ///< that scans wait for
  bool ended_ = false;             ///< the main reader
  bool finished_ = false;
  std::exception_ptr failure_;
};

}  // namespace

bool is_scan_type(const RecordedTopic& topic) {
  return encoding_of(topic) && (topic.type == ros::kPointCloud2 || is_livox_type(topic.type) ||
                                is_velodyne_type(topic.type));
}

bool is_imu_type(const RecordedTopic& topic) {
  return encoding_of(topic) && topic.type == ros::kImu;
}

std::unique_ptr<EventSource> open_recorded_events(const std::filesystem::path& file,
                                                  const RecordedSensors& sensors,
                                                  const RecordingInfo& info,
                                                  std::shared_ptr<ReadReport> report) {
  std::vector<std::string> imus;
  for (const auto& [topic, id] : sensors.imus) {
    if (info.count_of(topic) > 0) imus.push_back(id);
  }
  return std::make_unique<RecordedEvents>(file, sensors, imus, std::move(report));
}

}  // namespace lidarena::dataset
