// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <map>
#include <optional>
#include <span>
#include <vector>

#include "lidarena/dataset/dataset_layout.hpp"
#include "lidarena/dataset/dataset_store.hpp"
#include "lidarena/dataset/messages/driver_layouts.hpp"
#include "lidarena/dataset/messages/ros_messages.hpp"
#include "lidarena/dataset/recording.hpp"

namespace lidarena::dataset {
namespace {

constexpr const char* kWorldFrame = "world";

std::string lidar_frame(const std::string& id) { return id + "_lidar"; }
std::string imu_frame(const std::string& id) { return id + "_imu"; }

RecordingOptions recording_options(const Rig& rig, const RecordedSensors& sensors,
                                   const WriteOptions& options, bool is_folder) {
  const bool is_bag = options.format == DatasetFormat::kBag;
  return {is_bag ? RecordingFormat::kBag : RecordingFormat::kMcap, is_folder, options.compress,
          layout::kDescription, layout::describe({rig, sensors})};
}

/// The driver whose message layouts are used for a LiDAR and for its built-in IMU, which has the
/// same id.
Driver driver_of(const std::string& id, const Rig& rig, const WriteOptions& options) {
  if (options.dialect == Dialect::kSi) return Driver::kUnknown;
  const auto lidar = std::ranges::find(rig.lidars, id, &LidarInfo::id);
  return lidar == rig.lidars.end() ? Driver::kUnknown : dataset::driver_of(*lidar);
}

/// The topics from which the measurements are read back: for a Livox in Dialect::kDriver, its
/// CustomMsg.
RecordedSensors sensors_of(const Rig& rig, const WriteOptions& options) {
  RecordedSensors sensors = layout::topics_of(rig);
  for (const LidarInfo& lidar : rig.lidars) {
    if (driver_of(lidar.id, rig, options) != Driver::kLivox) continue;
    std::erase_if(sensors.lidars, [&](const auto& entry) { return entry.second == lidar.id; });
    sensors.lidars[layout::livox_topic_of(lidar.id)] = lidar.id;
  }
  for (const ImuInfo& imu : rig.imus) {
    if (driver_of(imu.id, rig, options) == Driver::kLivox) sensors.imu_units[imu.id] = kInG;
  }
  return sensors;
}

class RecordingStore final : public DatasetStore {
 public:
  RecordingStore(std::shared_ptr<RecordingWriter> recording, const Rig& rig,
                 const WriteOptions& options)
      : rig_(rig),
        sensors_(sensors_of(rig, options)),
        recording_(std::move(recording)),
        message_(recording_->encoding()) {
    tf_static_ = recording_->add_topic("/tf_static", ros::kTfMessage, true);
    const RecordedSensors topics = layout::topics_of(rig);
    for (const auto& [topic, id] : topics.lidars) {
      LidarTopics& lidar = lidars_[id];
      lidar.info = *std::ranges::find(rig_.lidars, id, &LidarInfo::id);
      lidar.driver = driver_of(id, rig_, options);
      lidar.points = recording_->add_topic(topic, ros::kPointCloud2);
      if (lidar.driver != Driver::kLivox) continue;
      lidar.custom = recording_->add_topic(layout::livox_topic_of(id),
                                           livox_type(lidar.info, message_.encoding()));
    }
    for (const auto& [topic, id] : topics.imus) {
      imus_[id] = {driver_of(id, rig_, options), recording_->add_topic(topic, ros::kImu)};
    }
  }

  void write(const std::string& id, const ImuSample& sample) override {
    write_mounting(sample.stamp);
    const ImuTopic& imu = imus_.at(id);
    encode_driver_imu(sample, imu.driver, imu_frame(id), message_);
    write_message(imu.topic, sample.stamp);
  }

  void write(const std::string& id, const Scan& scan) override {
    write_mounting(scan.stamp);
    const LidarTopics& lidar = lidars_.at(id);
    const std::string frame = lidar_frame(id);
    const Time end = end_of(scan);
    if (lidar.driver == Driver::kLivox) {
      encode_livox_custom(scan, lidar.info, frame, message_);
      write_message(lidar.custom, end);
      encode_livox_cloud(scan, lidar.info, frame, message_);
    } else if (lidar.driver == Driver::kOuster) {
      encode_ouster_cloud(scan, lidar.info, frame, message_);
    } else {
      ros::encode_scan(scan, frame, message_);
    }
    write_message(lidar.points, end);
  }

  void write(const ScanTruth& truth) override {
    const auto [entry, is_new] = hits_.try_emplace(truth.sensor_id, 0);
    if (is_new) {
      entry->second =
          recording_->add_topic(layout::truth_topic_of(truth.sensor_id), ros::kPointCloud2);
    }
    write_mounting(truth.stamp);
    ros::encode_scan_truth(truth, kWorldFrame, message_);
    write_message(entry->second, truth.stamp);
  }

  void write_truth(const StampedPose& pose) override {
    if (!odometry_) {
      odometry_ = recording_->add_topic(layout::kTruthTopic, ros::kOdometry);
      tf_ = recording_->add_topic("/tf", ros::kTfMessage);
    }
    write_mounting(pose.stamp);
    ros::encode_odometry(pose, {kWorldFrame, rig_.body_frame}, message_);
    write_message(*odometry_, pose.stamp);
    const ros::StampedTransform transform{pose.stamp, kWorldFrame, rig_.body_frame,
                                          pose.world_from_body};
    ros::encode_transforms(std::span(&transform, 1), message_);
    write_message(tf_, pose.stamp);
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
  /// Writes the mounting of the sensors, once, with the time of the first message.
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
    write_message(tf_static_, time);
  }

  /// Writes the encoded message. Its log time is never earlier than that of the message before, so
  /// that readers that sort by log time keep the order of EventSource.
  void write_message(std::uint16_t topic, Time published) {
    latest_ = std::max(latest_, published);
    recording_->write(topic, latest_, published, message_.bytes());
  }

  struct LidarTopics {
    LidarInfo info;
    Driver driver = Driver::kUnknown;
    std::uint16_t points = 0;
    std::uint16_t custom = 0;  ///< CustomMsg of a Livox
  };
  struct ImuTopic {
    Driver driver = Driver::kUnknown;
    std::uint16_t topic = 0;
  };

  Rig rig_;
  RecordedSensors sensors_;
  std::shared_ptr<RecordingWriter> recording_;
  std::map<std::string, LidarTopics> lidars_;  ///< by sensor id
  std::map<std::string, ImuTopic> imus_;
  std::map<std::string, std::uint16_t> hits_;  ///< ground truth of points, by sensor id
  std::uint16_t tf_static_ = 0;
  std::uint16_t tf_ = 0;
  std::optional<std::uint16_t> odometry_;
  MessageWriter message_;
  bool mounting_written_ = false;
  Time latest_{1};  ///< log time of the last message; ROS 1 takes a time of 0 for an invalid one
};

}  // namespace

std::unique_ptr<DatasetStore> make_recording_store(const std::filesystem::path& file,
                                                   const Rig& rig, const WriteOptions& options,
                                                   bool is_folder) {
  return std::make_unique<RecordingStore>(
      create_recording(file, recording_options(rig, sensors_of(rig, options), options, is_folder)),
      rig, options);
}

std::unique_ptr<DatasetStore> make_message_store(std::shared_ptr<RecordingWriter> out,
                                                 const Rig& rig, const WriteOptions& options) {
  return std::make_unique<RecordingStore>(std::move(out), rig, options);
}

}  // namespace lidarena::dataset
