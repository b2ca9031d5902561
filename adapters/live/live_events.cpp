// SPDX-License-Identifier: BSD-3-Clause
#include "adapters/live/live_events.hpp"

#include <fmt/format.h>

#include <utility>

#include "lidarena/base/error.hpp"
#include "lidarena/dataset/messages/livox_message.hpp"
#include "lidarena/dataset/messages/ros_messages.hpp"
#include "lidarena/dataset/text_file.hpp"

namespace lidarena::live {
namespace {

constexpr const char* kLiveTopics = "live topics";

Scan live_scan(const dataset::RecordedMessage& message, const std::string& topic) {
  if (dataset::is_livox_type(message.type)) return dataset::decode_livox(message.data, topic);
  if (message.type != dataset::ros::kPointCloud2)
    throw InputError(topic, fmt::format("messages of {} are no scans", message.type));
  return dataset::ros::decode_scan(message.data, topic);
}

ImuSample live_sample(const dataset::RecordedMessage& message, const std::string& topic) {
  if (message.type != dataset::ros::kImu)
    throw InputError(topic, fmt::format("messages of {} are not an IMU's", message.type));
  const ImuSample sample = dataset::ros::decode_imu(message.data, topic);
  if (sample.gyro.allFinite() && sample.accel.allFinite()) return sample;
  throw InputError(topic, "a sample is not finite");
}

Time stamp_of_event(const Event& event) {
  return std::visit([](const auto& data) { return data.stamp; }, event.data);
}

}  // namespace

LiveEvents::LiveEvents(const dds::LiveOptions& live, dds::LiveReaderOptions reading,
                       dataset::RecordedSensors sensors, const std::vector<std::string>& imus,
                       LogSink& log)
    : sensors_(std::move(sensors)),
      log_(log),
      reader_(live, std::move(reading)),
      merge_(kLiveTopics, imus) {}

std::optional<Event> LiveEvents::next() {
  for (;;) {
    if (auto event = merge_.pop()) return event;
    if (finished_) return std::nullopt;
    read_next();
  }
}

void LiveEvents::read_next() {
  try {
    if (const auto message = reader_.next()) return deliver(*message);
  } catch (const InputError& error) {  // of the merge: an IMU has failed
    ended_ = error.what();
    log_.warn(ended_);
  }
  finished_ = true;
  merge_.finish();
}

void LiveEvents::deliver(const dataset::RecordedMessage& message) {
  const std::string topic(message.topic);
  std::optional<Event> event = decoded(message, topic);
  if (event && is_later(*event, topic)) merge_.push(*std::move(event));
}

std::optional<Event> LiveEvents::decoded(const dataset::RecordedMessage& message,
                                         const std::string& topic) {
  try {
    if (const auto imu = sensors_.imus.find(topic); imu != sensors_.imus.end())
      return Event{imu->second, live_sample(message, topic)};
    if (const auto lidar = sensors_.lidars.find(topic); lidar != sensors_.lidars.end())
      return Event{lidar->second, live_scan(message, topic)};
  } catch (const InputError& error) {
    if (++faults_[topic].bad == 1)
      log_.warn(fmt::format("{}; such messages are left out", error.what()));
  }
  return std::nullopt;
}

bool LiveEvents::is_later(const Event& event, const std::string& topic) {
  Faults& of_topic = faults_[topic];
  const Time stamp = stamp_of_event(event);
  const bool may_repeat = std::holds_alternative<ImuSample>(event.data);  // as some drivers do
  if (of_topic.last && (may_repeat ? stamp < *of_topic.last : stamp <= *of_topic.last)) {
    if (++of_topic.out_of_order == 1) {
      log_.warn(fmt::format("{}: a stamp of {} s after one of {} s; such messages are left out",
                            topic, dataset::format_seconds(stamp),
                            dataset::format_seconds(*of_topic.last)));
    }
    return false;
  }
  of_topic.last = stamp;
  return true;
}

Json LiveEvents::summary() const {
  Json summary = Json::object();
  for (const auto& [topic, of_topic] : faults_) {
    if (of_topic.bad > 0) summary["bad"][topic] = of_topic.bad;
    if (of_topic.out_of_order > 0) summary["out_of_order"][topic] = of_topic.out_of_order;
  }
  for (const dataset::RecordedTopic& topic : reader_.topics()) {
    if (const std::uint64_t lost = reader_.lost(topic.topic); lost > 0)
      summary["lost"][topic.topic] = lost;
  }
  if (!ended_.empty()) summary["ended"] = ended_;
  return summary;
}

}  // namespace lidarena::live
