// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <map>
#include <optional>
#include <span>
#include <vector>

#include "lidarena/dataset/dataset_layout.hpp"
#include "lidarena/dataset/dataset_store.hpp"
#include "lidarena/dataset/recording.hpp"
#include "lidarena/dataset/ros_messages.hpp"

namespace lidarena {
namespace {

constexpr const char* kWorldFrame = "world";

std::string lidar_frame(const std::string& id) { return id + "_lidar"; }
std::string imu_frame(const std::string& id) { return id + "_imu"; }

RecordingOptions recording_options(const Rig& rig, const RecordedSensors& sensors,
                                   const WriteOptions& options, bool is_folder) {
  const bool is_bag = options.format == DatasetFormat::kBag;
  return {is_bag ? RecordingFormat::kBag : RecordingFormat::kMcap, is_folder, layout::kDescription,
          layout::describe({rig, sensors})};
}

class RecordingStore final : public DatasetStore {
 public:
  RecordingStore(const std::filesystem::path& file, const Rig& rig, const WriteOptions& options,
                 bool is_folder)
      : rig_(rig),
        sensors_(layout::topics_of(rig)),
        recording_(create_recording(file, recording_options(rig, sensors_, options, is_folder))),
        message_(recording_->encoding()) {
    tf_static_ = recording_->add_topic("/tf_static", ros::kTfMessage, true);
    for (const auto& [topic, id] : sensors_.lidars) {
      lidars_[id] = recording_->add_topic(topic, ros::kPointCloud2);
    }
    for (const auto& [topic, id] : sensors_.imus) {
      imus_[id] = recording_->add_topic(topic, ros::kImu);
    }
  }

  void write(const std::string& id, const ImuSample& sample) override {
    write_mounting(sample.stamp);
    ros::encode_imu(sample, imu_frame(id), message_);
    write_measurement(imus_.at(id), sample.stamp);
  }

  void write(const std::string& id, const Scan& scan) override {
    write_mounting(scan.stamp);
    ros::encode_scan(scan, lidar_frame(id), message_);
    write_measurement(lidars_.at(id), end_of(scan));
  }

  void write(const ScanTruth& truth) override {
    const auto [entry, is_new] = hits_.try_emplace(truth.sensor_id, 0);
    if (is_new) {
      entry->second =
          recording_->add_topic(layout::truth_topic_of(truth.sensor_id), ros::kPointCloud2);
    }
    write_mounting(truth.stamp);
    ros::encode_scan_truth(truth, kWorldFrame, message_);
    recording_->write(entry->second, truth.stamp, truth.stamp, message_.bytes());
  }

  void write_truth(const StampedPose& pose) override {
    if (!odometry_) {
      odometry_ = recording_->add_topic(layout::kTruthTopic, ros::kOdometry);
      tf_ = recording_->add_topic("/tf", ros::kTfMessage);
    }
    write_mounting(pose.stamp);
    ros::encode_odometry(pose, kWorldFrame, rig_.body_frame, message_);
    recording_->write(*odometry_, pose.stamp, pose.stamp, message_.bytes());
    const ros::StampedTransform transform{pose.stamp, kWorldFrame, rig_.body_frame,
                                          pose.world_from_body};
    ros::encode_transforms(std::span(&transform, 1), message_);
    recording_->write(tf_, pose.stamp, pose.stamp, message_.bytes());
  }

  Json finish() override {
    const RecordingInfo written = recording_->info();
    recording_->close();
    Json counts = Json::object();
    for (const RecordedTopic& topic : written.topics) counts[topic.topic] = topic.message_count;
    return {{"topics", layout::to_json(sensors_)},
            {"message_counts", counts},
            {"start_ns", written.start.count()},
            {"end_ns", written.end.count()}};
  }

 private:
  /// The mounting of the sensors, once, at the time of the first message.
  void write_mounting(Time time) {
    if (mounting_written_) return;
    mounting_written_ = true;
    std::vector<ros::StampedTransform> mounting;
    for (const LidarInfo& lidar : rig_.lidars) {
      mounting.push_back({time, rig_.body_frame, lidar_frame(lidar.id), lidar.body_from_lidar});
    }
    for (const ImuInfo& imu : rig_.imus) {
      mounting.push_back({time, rig_.body_frame, imu_frame(imu.id), imu.body_from_imu});
    }
    ros::encode_transforms(mounting, message_);
    recording_->write(tf_static_, time, time, message_.bytes());
  }

  /// Measurements leave in the order they came: a message never has an earlier log time than the
  /// measurement before it, so readers that sort by log time keep the order of EventSource.
  void write_measurement(std::uint16_t topic, Time published) {
    latest_ = std::max(latest_, published);
    recording_->write(topic, latest_, published, message_.bytes());
  }

  Rig rig_;
  RecordedSensors sensors_;
  std::unique_ptr<RecordingWriter> recording_;
  std::map<std::string, std::uint16_t> lidars_;  ///< sensor id -> topic
  std::map<std::string, std::uint16_t> imus_;
  std::map<std::string, std::uint16_t> hits_;  ///< truth of the points
  std::uint16_t tf_static_ = 0;
  std::uint16_t tf_ = 0;
  std::optional<std::uint16_t> odometry_;
  MessageWriter message_;
  bool mounting_written_ = false;
  Time latest_{0};  ///< log time of the measurement last written
};

}  // namespace

std::unique_ptr<DatasetStore> make_recording_store(const std::filesystem::path& file,
                                                   const Rig& rig, const WriteOptions& options,
                                                   bool is_folder) {
  return std::make_unique<RecordingStore>(file, rig, options, is_folder);
}

}  // namespace lidarena
