// SPDX-License-Identifier: BSD-3-Clause
#include "adapters/live/player.hpp"

#include <algorithm>
#include <map>
#include <vector>

#include "lidarena/base/error.hpp"
#include "lidarena/dataset/dataset_layout.hpp"
#include "lidarena/dataset/recording.hpp"
#include "lidarena/dataset/recording_source.hpp"

namespace lidarena::live {
namespace {

/// Topics of scans; in a recording of our own, one for each LiDAR.
std::vector<std::string> scan_topics(const dataset::RecordingInfo& info, const std::string& place) {
  std::vector<std::string> topics;
  if (const auto described = dataset::layout::description_in(info, place)) {
    for (const auto& [topic, lidar] : described->sensors.lidars) topics.push_back(topic);
    return topics;
  }
  for (const dataset::RecordedTopic& topic : info.topics) {
    if (dataset::is_scan_type(topic) && !topic.topic.starts_with(dataset::layout::kTruthPrefix))
      topics.push_back(topic.topic);
  }
  return topics;
}

}  // namespace

std::filesystem::path recording_in(const std::filesystem::path& dataset) {
  if (!std::filesystem::is_directory(dataset)) return dataset;
  if (std::filesystem::exists(dataset / dataset::layout::kData))
    return dataset / dataset::layout::kData;
  throw InputError(dataset.string(), "has no data.mcap",
                   "lidarena convert " + dataset.string() + " OUT");
}

std::string scan_topic_of(const std::filesystem::path& recording, const std::string& asked) {
  const dataset::RecordingInfo info = dataset::read_recording_info(recording);
  const std::vector<std::string> topics = scan_topics(info, recording.string());
  std::string list;
  for (const std::string& topic : topics) list += (list.empty() ? "" : ", ") + topic;
  if (!asked.empty()) {
    if (info.count_of(asked) > 0) return asked;
    throw InputError(recording.string(), "has no messages on " + asked,
                     "topics of scans are: " + list);
  }
  if (topics.size() == 1) return topics.front();
  throw InputError(recording.string(),
                   topics.empty() ? "has no scans" : "has several topics of scans",
                   topics.empty() ? "" : "choose one with --points-topic: " + list);
}

void play_recording(const std::filesystem::path& recording, PacedWriter& out,
                    const std::function<bool()>& stopped, LogSink& log) {
  const dataset::RecordingInfo info = dataset::read_recording_info(recording);
  std::map<std::string, std::uint16_t, std::less<>> topics;
  for (const dataset::RecordedTopic& topic : info.topics) {
    if (topic.message_encoding != "cdr") {
      throw InputError(recording.string(), "has messages of another kind than ROS 2's",
                       "lidarena convert " + recording.string() + " OUT.mcap");
    }
    topics[topic.topic] = out.add_topic(topic.topic, topic.type, topic.topic == "/tf_static");
  }
  const auto reader = dataset::open_recording(recording);
  while (const auto message = reader->next()) {
    if (stopped()) break;
    out.write(topics.find(message->topic)->second, message->log_time, message->log_time,
              message->data);
    log.progress("play", to_seconds(message->log_time - info.start),
                 to_seconds(info.end - info.start));
  }
}

}  // namespace lidarena::live
