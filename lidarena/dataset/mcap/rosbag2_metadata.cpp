// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/dataset/mcap/rosbag2_metadata.hpp"

#include <fmt/format.h>

#include "lidarena/base/config_json.hpp"

namespace lidarena::dataset {
namespace {

/// A JSON string, which is a valid YAML scalar for any content.
std::string quoted(const std::string& text) { return Json(text).dump(); }

}  // namespace

std::string default_qos() { return ""; }

std::string latched_qos() {
  // Numeric values of rmw: history keep last, reliable, transient local; liveliness automatic; no
  // deadlines.
  constexpr const char* kForever = "{sec: 9223372036, nsec: 854775807}";
  return fmt::format(
      "- history: 1\n  depth: 1\n  reliability: 1\n  durability: 1\n  deadline: {0}\n"
      "  lifespan: {0}\n  liveliness: 1\n  liveliness_lease_duration: {0}\n"
      "  avoid_ros_namespace_conventions: false",
      kForever);
}

std::string rosbag2_metadata(const std::string& file, const std::vector<RosbagTopic>& topics,
                             Time start, Time end) {
  std::uint64_t message_count = 0;
  std::string topic_list;
  for (const RosbagTopic& topic : topics) {
    message_count += topic.message_count;
    topic_list += fmt::format(
        "    - topic_metadata:\n"
        "        name: {}\n"
        "        type: {}\n"
        "        serialization_format: cdr\n"
        "        offered_qos_profiles: {}\n"
        "      message_count: {}\n",
        quoted(topic.name), quoted(topic.type), quoted(topic.qos), topic.message_count);
  }
  const auto duration = (end - start).count();
  return fmt::format(
      "rosbag2_bagfile_information:\n"
      "  version: 5\n"
      "  storage_identifier: mcap\n"
      "  duration:\n"
      "    nanoseconds: {1}\n"
      "  starting_time:\n"
      "    nanoseconds_since_epoch: {2}\n"
      "  message_count: {3}\n"
      "  topics_with_message_count:\n{4}"
      "  compression_format: \"\"\n"
      "  compression_mode: \"\"\n"
      "  relative_file_paths:\n"
      "    - {0}\n"
      "  files:\n"
      "    - path: {0}\n"
      "      starting_time:\n"
      "        nanoseconds_since_epoch: {2}\n"
      "      duration:\n"
      "        nanoseconds: {1}\n"
      "      message_count: {3}\n",
      quoted(file), duration, start.count(), message_count, topic_list);
}

}  // namespace lidarena::dataset
