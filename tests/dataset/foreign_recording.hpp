// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstring>
#include <filesystem>
#include <string>
#include <vector>

#include "lidarena/dataset/messages/point_cloud2.hpp"
#include "lidarena/dataset/messages/ros_messages.hpp"
#include "lidarena/dataset/recording.hpp"

namespace lidarena::dataset {

/// The time field of a driver's points; without a name, the points have none.
struct TimeField {
  std::string name;
  ros::FieldType type = ros::FieldType::kFloat32;
};

/// Writes recordings as other people's drivers do, message by message.
class ForeignRecording {
 public:
  static constexpr Time kEpoch = std::chrono::seconds(1'700'000'000);

  explicit ForeignRecording(const std::filesystem::path& file)
      : out_(create_recording(file, options_for(file))), message_(out_->encoding()) {}

  /// A sweep of points on a circle, with these values of the time field.
  void sweep(const std::string& topic, Time stamp, const TimeField& field,
             const std::vector<double>& times, Time log_time, const std::string& frame = "lidar") {
    std::vector<ros::PointField> fields{{"x", 0, ros::FieldType::kFloat32},
                                        {"y", 4, ros::FieldType::kFloat32},
                                        {"z", 8, ros::FieldType::kFloat32}};
    if (!field.name.empty()) fields.push_back({field.name, 12, field.type});
    message_.clear();
    ros::put_header(stamp, frame, message_);
    std::byte* at = ros::put_layout(1, times.size(), kStep, fields, message_).data();
    for (const double time : times) {
      store(5.0F, at);
      if (!field.name.empty()) store_time(time, field.type, at + 12);
      at += kStep;
    }
    message_.put(std::uint8_t{1});
    write(topic, ros::kPointCloud2, log_time);
  }
  void imu(const std::string& topic, const ImuSample& sample, Time log_time,
           const std::string& frame = "imu") {
    ros::encode_imu(sample, frame, message_);
    write(topic, ros::kImu, log_time);
  }
  void frames(const std::vector<ros::StampedTransform>& transforms, Time log_time) {
    ros::encode_transforms(transforms, message_);
    write("/tf_static", ros::kTfMessage, log_time);
  }
  void odometry(const std::string& topic, const StampedPose& pose) {
    ros::encode_odometry(pose, {"odom", "base_link"}, message_);
    write(topic, ros::kOdometry, pose.stamp);
  }
  void close() { out_->close(); }

 private:
  static constexpr std::size_t kStep = 24;

  static RecordingOptions options_for(const std::filesystem::path& file) {
    RecordingOptions options;
    options.format = recording_format_of(file).value();
    return options;
  }

  template <class T>
  static void store(T value, std::byte* at) {
    std::memcpy(at, &value, sizeof value);
  }
  static void store_time(double time, ros::FieldType type, std::byte* at) {
    if (type == ros::FieldType::kFloat32) return store(static_cast<float>(time), at);
    if (type == ros::FieldType::kFloat64) return store(time, at);
    store(static_cast<std::uint32_t>(static_cast<std::int64_t>(time)), at);
  }
  void write(const std::string& topic, std::string_view type, Time log_time) {
    if (!topics_.contains(topic)) topics_[topic] = out_->add_topic(topic, type);
    out_->write(topics_[topic], log_time, log_time, message_.bytes());
  }

  std::unique_ptr<RecordingWriter> out_;
  MessageWriter message_;
  std::map<std::string, std::uint16_t> topics_;
};

}  // namespace lidarena::dataset
