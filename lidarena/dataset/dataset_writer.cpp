// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <filesystem>
#include <vector>

#include "lidarena/base/error.hpp"
#include "lidarena/dataset/dataset.hpp"
#include "lidarena/dataset/dataset_layout.hpp"
#include "lidarena/dataset/json_file.hpp"
#include "lidarena/dataset/mcap_writer.hpp"
#include "lidarena/dataset/part_file.hpp"
#include "lidarena/dataset/ros_messages.hpp"
#include "lidarena/dataset/rosbag2_metadata.hpp"
#include "lidarena/dataset/tum.hpp"

namespace lidarena {
namespace {

constexpr const char* kWorldFrame = "world";

std::filesystem::path prepared(const std::filesystem::path& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) throw InputError(folder.string(), "cannot be created: " + error.message());
  // What an earlier dataset left must not vouch for this one, nor pass for its truth.
  for (const char* stale :
       {layout::kManifest, layout::kTruth, layout::kTruthPart, layout::kRosbagMetadata}) {
    std::filesystem::remove(folder / stale, error);
  }
  return folder;
}

std::string lidar_frame(const std::string& id) { return id + "_lidar"; }
std::string imu_frame(const std::string& id) { return id + "_imu"; }

}  // namespace

struct DatasetWriter::Impl {
  Impl(const std::filesystem::path& path, const Rig& r)
      : folder(prepared(path)),
        rig(r),
        sensors(layout::topics_of(r)),
        mcap(folder / layout::kData) {
    mcap.add_metadata(layout::kDescription, layout::describe({rig, sensors}));
    tf_static = add_topic("/tf_static", ros::kTfMessage, latched_qos());
    for (const auto& [topic, id] : sensors.lidars) lidars[id] = add_topic(topic, ros::kPointCloud2);
    for (const auto& [topic, id] : sensors.imus) imus[id] = add_topic(topic, ros::kImu);
  }

  std::uint16_t add_topic(const std::string& name, std::string_view type,
                          const std::string& qos = default_qos()) {
    std::uint16_t& schema = schemas[std::string(type)];
    if (schema == 0) {
      schema = mcap.add_schema(std::string(type), "ros2msg", ros::definition_of(type));
    }
    topics.push_back({name, std::string(type), qos});
    return mcap.add_channel(name, schema, "cdr", {{"offered_qos_profiles", qos}});
  }

  /// The mounting of the sensors, once, at the time of the first message.
  void write_mounting(Time time) {
    if (mounting_written) return;
    mounting_written = true;
    std::vector<ros::StampedTransform> mounting;
    for (const LidarInfo& lidar : rig.lidars) {
      mounting.push_back({time, rig.body_frame, lidar_frame(lidar.id), lidar.body_from_lidar});
    }
    for (const ImuInfo& imu : rig.imus) {
      mounting.push_back({time, rig.body_frame, imu_frame(imu.id), imu.body_from_imu});
    }
    ros::encode_transforms(mounting, message);
    mcap.write(tf_static, time, time, message.bytes());
  }

  /// Measurements leave in the order they came: a message never has an earlier log time than the
  /// measurement before it, so readers that sort by log time keep the order of EventSource.
  void write_measurement(std::uint16_t channel, Time published) {
    latest = std::max(latest, published);
    mcap.write(channel, latest, published, message.bytes());
  }

  std::uint16_t channel_of(const std::map<std::string, std::uint16_t>& channels,
                           const std::string& id) const {
    const auto channel = channels.find(id);
    if (channel != channels.end()) return channel->second;
    throw InputError(folder.string(), "'" + id + "' is not among the sensors of the rig",
                     "name every sensor in the rig");
  }

  void write(const std::string& id, const ImuSample& sample) {
    const std::uint16_t channel = channel_of(imus, id);
    write_mounting(sample.stamp);
    ros::encode_imu(sample, imu_frame(id), message);
    write_measurement(channel, sample.stamp);
  }

  void write(const std::string& id, const Scan& scan) {
    const std::uint16_t channel = channel_of(lidars, id);
    write_mounting(scan.stamp);
    ros::encode_scan(scan, lidar_frame(id), message);
    write_measurement(channel, end_of(scan));
  }

  void write(const ScanTruth& scan_truth) {
    channel_of(lidars, scan_truth.sensor_id);  // says so if the rig lacks it
    const auto [entry, is_new] = hits.try_emplace(scan_truth.sensor_id, 0);
    if (is_new) {
      entry->second = add_topic(layout::truth_topic_of(scan_truth.sensor_id), ros::kPointCloud2);
    }
    ros::encode_scan_truth(scan_truth, kWorldFrame, message);
    mcap.write(entry->second, scan_truth.stamp, scan_truth.stamp, message.bytes());
  }

  void write_rosbag_metadata();
  Json manifest_with(const Json& extra) const;

  std::filesystem::path folder;
  Rig rig;
  McapSensors sensors;
  McapWriter mcap;
  std::map<std::string, std::uint16_t> schemas;
  std::map<std::string, std::uint16_t> lidars;  ///< sensor id -> channel
  std::map<std::string, std::uint16_t> imus;
  std::map<std::string, std::uint16_t> hits;  ///< truth of the points
  std::vector<RosbagTopic> topics;            ///< by channel id - 1
  std::uint16_t tf_static = 0;
  std::uint16_t tf = 0;
  std::uint16_t odometry = 0;
  MessageWriter message;
  bool mounting_written = false;
  Time latest{0};  ///< log time of the measurement last written
  std::optional<TumWriter> truth;
  bool finished = false;
};

DatasetWriter::DatasetWriter(const std::filesystem::path& folder, const Rig& rig)
    : impl_(std::make_unique<Impl>(folder, rig)) {}

DatasetWriter::~DatasetWriter() = default;

void DatasetWriter::write(const Event& event) {
  std::visit([&](const auto& data) { impl_->write(event.sensor_id, data); }, event.data);
}

void DatasetWriter::write(const ScanTruth& truth) { impl_->write(truth); }

void DatasetWriter::write_truth(const StampedPose& pose) {
  Impl& w = *impl_;
  if (!w.truth) {
    w.truth.emplace(w.folder / layout::kTruth, kTruthHeader);
    w.odometry = w.add_topic(layout::kTruthTopic, ros::kOdometry);
    w.tf = w.add_topic("/tf", ros::kTfMessage);
  }
  w.write_mounting(pose.stamp);
  ros::encode_odometry(pose, kWorldFrame, w.rig.body_frame, w.message);
  w.mcap.write(w.odometry, pose.stamp, pose.stamp, w.message.bytes());
  const ros::StampedTransform transform{pose.stamp, kWorldFrame, w.rig.body_frame,
                                        pose.world_from_body};
  ros::encode_transforms(std::span(&transform, 1), w.message);
  w.mcap.write(w.tf, pose.stamp, pose.stamp, w.message.bytes());
  w.truth->write(pose);
}

/// The bag's description twice, as rosbag2 itself writes it: beside the file and in it. Without the
/// latter, newer versions misread the QoS.
void DatasetWriter::Impl::write_rosbag_metadata() {
  const mcap::Statistics& statistics = mcap.statistics();
  for (std::size_t i = 0; i < topics.size(); ++i) {
    topics[i].message_count =
        statistics.channel_message_counts.at(static_cast<std::uint16_t>(i + 1));
  }
  const auto as_time = [](std::uint64_t ns) { return Time{static_cast<std::int64_t>(ns)}; };
  const std::string yaml =
      rosbag2_metadata(layout::kData, topics, as_time(statistics.message_start_time),
                       as_time(statistics.message_end_time));
  mcap.add_metadata("rosbag2", {{"serialized_metadata", yaml}});
  write_text_file(folder / layout::kRosbagMetadata, yaml);
}

Json DatasetWriter::Impl::manifest_with(const Json& extra) const {
  Json counts = Json::object();
  for (const RosbagTopic& topic : topics) counts[topic.name] = topic.message_count;
  Json manifest{{"format", layout::kFormat},
                {"format_version", layout::kFormatVersion},
                {"rig", to_json(rig)},
                {"topics", layout::to_json(sensors)},
                {"message_counts", counts},
                {"start_ns", mcap.statistics().message_start_time},
                {"end_ns", mcap.statistics().message_end_time}};
  for (const auto& [key, value] : extra.items()) {
    if (!manifest.contains(key)) manifest[key] = value;
  }
  return manifest;
}

void DatasetWriter::finish(const Json& manifest) {
  Impl& w = *impl_;
  if (w.finished) return;
  w.write_rosbag_metadata();
  w.mcap.close();
  if (w.truth) w.truth->close();
  write_json(w.folder / layout::kManifest, w.manifest_with(manifest));
  w.finished = true;
}

void DatasetWriter::close() { finish(Json::object()); }

}  // namespace lidarena
