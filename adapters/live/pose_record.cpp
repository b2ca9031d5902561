// SPDX-License-Identifier: BSD-3-Clause
#include "adapters/live/pose_record.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "lidarena/base/error.hpp"
#include "lidarena/dataset/dataset_layout.hpp"
#include "lidarena/dataset/messages/point_cloud2.hpp"
#include "lidarena/dataset/messages/ros_messages.hpp"
#include "lidarena/dataset/trajectories/trajectory_rows.hpp"

namespace lidarena::live {
namespace {

namespace ros = dataset::ros;

/// A geometry_msgs/msg/Pose. Throws InputError for one that is none.
Pose pose_in(dataset::MessageReader& in, const std::string& place) {
  std::array<double, 7> v{};
  for (double& value : v) {
    value = in.get<double>();
    if (!std::isfinite(value)) throw InputError(place, "a pose is not finite");
  }
  return dataset::pose_from_row(Eigen::Vector3d(v[0], v[1], v[2]),
                                Eigen::Quaterniond(v[6], v[3], v[4], v[5]), place);
}

void check_advance(const std::vector<StampedPose>& poses, Time stamp, const std::string& place) {
  if (!poses.empty() && stamp <= poses.back().stamp)
    throw InputError(place, "a pose is not later than the one before");
}

bool is_pose_type(std::string_view type) { return type == ros::kOdometry || type == ros::kPath; }

/// Frame ids with and without a slash in front are the same.
std::string_view without_slash(std::string_view frame) {
  return frame.starts_with('/') ? frame.substr(1) : frame;
}

}  // namespace

bool ResultTopics::wants(const std::string& topic, const std::string& type) const {
  if (topic == odometry || topic == path || topic == points) return true;
  return odometry.empty() && path.empty() && is_pose_type(type) &&
         !topic.starts_with(dataset::layout::kTruthPrefix);
}

void PoseRecord::add(const dataset::RecordedMessage& message) {
  const std::string topic(message.topic);
  if (!topics_.wants(topic, std::string(message.type))) return;
  try {
    read(message, topic);
  } catch (const InputError& error) {
    ++bad_[topic];
    if (first_fault_.empty()) first_fault_ = error.what();
  }
}

void PoseRecord::read(const dataset::RecordedMessage& message, const std::string& topic) {
  if (message.type == ros::kOdometry) return add_odometry(message, topic);
  if (message.type == ros::kPath) return add_path(message, topic);
  if (message.type == ros::kPointCloud2) return add_cloud(message, topic);
  throw InputError(topic, fmt::format("messages of {} are no results", message.type),
                   "poses are nav_msgs/msg/Odometry or Path, clouds sensor_msgs/msg/PointCloud2");
}

void PoseRecord::add_odometry(const dataset::RecordedMessage& message, const std::string& topic) {
  dataset::MessageReader in(message.data, topic);
  const ros::MessageHeader header = ros::get_header(in);
  const std::string body = in.get_string();
  const Pose pose = pose_in(in, topic);
  Poses& poses = poses_[topic];
  check_advance(poses.live, header.stamp, topic);
  poses.type = message.type;
  poses.world = header.frame_id;
  poses.body = body;
  poses.live.push_back({header.stamp, pose});
}

void PoseRecord::add_path(const dataset::RecordedMessage& message, const std::string& topic) {
  dataset::MessageReader in(message.data, topic);
  const std::string world = ros::get_header(in).frame_id;
  constexpr std::size_t kMinPoseBytes = 7 * sizeof(double);
  std::vector<StampedPose> path(in.get_length(kMinPoseBytes));
  for (StampedPose& pose : path) {
    pose.stamp = ros::get_header(in).stamp;
    pose.world_from_body = pose_in(in, topic);
  }
  // Some nodes add the same pose twice.
  const auto repeats = std::ranges::unique(path, {}, &StampedPose::stamp);
  path.erase(repeats.begin(), repeats.end());
  const bool sorted = std::ranges::is_sorted(path, {}, &StampedPose::stamp);
  if (path.empty() || !sorted)
    throw InputError(topic, path.empty() ? "a path is empty" : "a path goes back in time");
  Poses& poses = poses_[topic];
  poses.type = message.type;
  poses.world = world;
  // A path may be a window: poses before it are kept as they were.
  const auto known =
      std::ranges::lower_bound(poses.path, path.front().stamp, {}, &StampedPose::stamp);
  poses.path.erase(known, poses.path.end());
  poses.path.insert(poses.path.end(), path.begin(), path.end());
  if (poses.live.empty() || path.back().stamp > poses.live.back().stamp)
    poses.live.push_back(path.back());
}

void PoseRecord::add_cloud(const dataset::RecordedMessage& message, const std::string& topic) {
  dataset::MessageReader in(message.data, topic);
  const ros::MessageHeader header = ros::get_header(in);
  ros::PointCloud2 cloud = ros::get_cloud(in, topic);
  // Times do not matter here and need not be such that a scan can have them.
  std::erase_if(cloud.fields, [](const ros::PointField& field) {
    return field.name == "t" || field.name == "time" || field.name == "offset_time" ||
           field.name == "timestamp";
  });
  const Scan scan = ros::scan_from_cloud(header.stamp, cloud, topic);
  std::vector<Eigen::Vector3f> points;
  points.reserve(scan.points.size());
  for (const Point& point : scan.points) points.push_back(point.position);
  map_.insert(points);
  cloud_frame_ = header.frame_id;
}

bool PoseRecord::empty() const { return poses_.empty(); }

const PoseRecord::Poses* PoseRecord::chosen(const std::string& named, std::string_view type,
                                            std::string& topic) const {
  if (!topics_.odometry.empty() || !topics_.path.empty()) {
    const auto found = poses_.find(named);
    topic = named;
    return found == poses_.end() ? nullptr : &found->second;
  }
  const Poses* only = nullptr;
  std::string list;
  for (const auto& [name, poses] : poses_) {
    if (poses.type != type) continue;
    only = &poses;
    topic = name;
    list += (list.empty() ? "" : ", ") + name;
  }
  if (list.find(',') != std::string::npos) {
    throw InputError("live topics", fmt::format("several have poses ({}): {}", type, list),
                     "name one with --odometry-topic or --path-topic");
  }
  return only;
}

PoseRecord::Result PoseRecord::take(LogSink& log) {
  if (!first_fault_.empty()) {
    std::uint64_t count = 0;
    for (const auto& [topic, messages] : bad_) count += messages;
    log.warn(fmt::format("{} messages are left out; the first: {}", count, first_fault_));
  }
  Result result;
  std::string odometry_topic, path_topic;
  const Poses* odometry = chosen(topics_.odometry, ros::kOdometry, odometry_topic);
  const Poses* path = nullptr;
  if (odometry == nullptr || !topics_.path.empty())
    path = chosen(topics_.path, ros::kPath, path_topic);
  if (odometry == nullptr && path == nullptr) {
    throw Error("no pose came on " + topics_.odometry + (topics_.path.empty() ? "" : " ") +
                topics_.path + (first_fault_.empty() ? "" : "; " + first_fault_));
  }
  const Poses& live = odometry != nullptr ? *odometry : *path;
  result.world = live.world;
  result.body = live.body;
  result.live = Trajectory(live.live, "live poses");
  result.trajectory = path != nullptr ? Trajectory(path->path, path_topic) : result.live;
  if (odometry != nullptr) result.topics["odometry"] = odometry_topic;
  if (path != nullptr) result.topics["path"] = path_topic;
  if (map_.size() == 0) return result;
  if (without_slash(cloud_frame_) != without_slash(result.world)) {
    log.warn(
        fmt::format("{}: its clouds are in the frame '{}', the poses in '{}': left out; name "
                    "the topic of the registered clouds",
                    topics_.points, cloud_frame_, result.world));
    return result;
  }
  result.topics["points"] = topics_.points;
  result.map = map_.take();
  return result;
}

}  // namespace lidarena::live
