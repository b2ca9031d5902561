// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/dataset/trajectories/recorded_trajectory.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <optional>

#include "lidarena/base/error.hpp"
#include "lidarena/dataset/damaged_file.hpp"
#include "lidarena/dataset/messages/ros_messages.hpp"
#include "lidarena/dataset/recording.hpp"
#include "lidarena/dataset/trajectories/trajectory_rows.hpp"

namespace lidarena::dataset {
namespace {

constexpr std::string_view kTransformStamped = "geometry_msgs/msg/TransformStamped";
/// A message type that consists of a header and a pose or transform (three numbers and a quaternion
/// x y z w), with child_frame_id between them if `names_child`.
struct PoseType {
  std::string_view name;
  bool names_child;
};
constexpr std::array kPoseTypes{PoseType{ros::kOdometry, true}, PoseType{kTransformStamped, true},
                                PoseType{"geometry_msgs/msg/PoseStamped", false},
                                PoseType{"geometry_msgs/msg/PoseWithCovarianceStamped", false}};

const PoseType* pose_type(std::string_view name) {
  for (const PoseType& type : kPoseTypes) {
    if (type.name == name) return &type;
  }
  return nullptr;
}

std::string chosen_topic(const std::filesystem::path& file, const std::string& asked) {
  std::vector<std::string> topics;
  std::string list;
  for (const RecordedTopic& topic : read_recording_info(file).topics) {
    if (pose_type(topic.type) == nullptr || !encoding_of(topic)) continue;
    topics.push_back(topic.topic);
    list += (list.empty() ? "" : ", ") + topic.topic;
    if (topic.topic == asked) return asked;
  }
  if (topics.empty()) {
    throw InputError(
        file.string(), "has no topic with poses",
        "supported types are Odometry, PoseStamped, PoseWithCovarianceStamped, TransformStamped");
  }
  if (!asked.empty()) {
    throw InputError(file.string(), "has no poses on topic '" + asked + "'", "it has: " + list);
  }
  if (topics.size() > 1) {
    throw InputError(file.string(), "has several topics with poses", "choose one of: " + list);
  }
  return topics.front();
}

double finite(MessageReader& in, const std::string& place) {
  const auto value = in.get<double>();
  if (!std::isfinite(value)) {
    throw InputError(place, "the pose is not finite",
                     "the program that wrote it had diverged there");
  }
  return value;
}

}  // namespace

FramedTrajectory read_recorded_trajectory(const std::filesystem::path& file,
                                          const std::string& asked) {
  const std::string topic = chosen_topic(file, asked);
  const auto reader = open_recording(file);
  FramedTrajectory read;
  TrajectoryRows rows(&read.repeated);
  const auto next = [&]() -> std::optional<RecordedMessage> {
    try {
      return reader->next();
    } catch (const DamagedFile& error) {
      read.ended = error.what();
      return std::nullopt;
    }
  };
  for (std::size_t number = 1; const auto message = next();) {
    if (message->topic != topic) continue;
    const std::string place = fmt::format("{}: {} message {}", file.string(), topic, number++);
    const PoseType* type = pose_type(message->type);
    if (type == nullptr) continue;
    MessageReader in(message->data, place, message->encoding);
    const ros::MessageHeader header = ros::get_header(in);
    read.world = header.frame_id;
    if (type->names_child) read.body = in.get_string();
    std::array<double, 7> v{};
    for (double& value : v) value = finite(in, place);
    const Eigen::Quaterniond rotation(v[6], v[3], v[4], v[5]);
    rows.add(header.stamp, pose_from_row(Eigen::Vector3d(v[0], v[1], v[2]), rotation, place),
             place);
  }
  read.trajectory = rows.finish(file.string() + ": " + topic);
  return read;
}

}  // namespace lidarena::dataset
