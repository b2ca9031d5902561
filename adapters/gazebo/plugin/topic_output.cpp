// SPDX-License-Identifier: BSD-3-Clause
#include <span>
#include <utility>

#include "adapters/gazebo/plugin/output.hpp"
#include "lidarena/dataset/messages/driver_layouts.hpp"
#include "lidarena/dataset/messages/ros_messages.hpp"

namespace lidarena::gazebo_plugin {
namespace {

namespace ros = lidarena::dataset::ros;
using ros::StampedTransform;

constexpr const char* kWorldFrame = "world";

class TopicOutput final : public Output {
 public:
  TopicOutput(const PluginConfig& config, const Rig& rig,
              std::unique_ptr<dataset::RecordingWriter> topics, const TopicOptions& options)
      : rig_(rig),
        info_(rig_.lidars.front()),
        driver_(config.dialect == dataset::Dialect::kDriver ? dataset::driver_of(info_)
                                                            : dataset::Driver::kUnknown),
        custom_(config.publish_pointcloud_type == 3),
        frame_(points_frame(config, rig)),
        imu_frame_(info_.id + "_imu"),
        options_(options),
        topics_(std::move(topics)),
        message_(topics_->encoding()) {
    points_ = topics_->add_topic(
        points_topic(config, rig),
        custom_ ? dataset::livox_type(info_, topics_->encoding()) : ros::kPointCloud2);
    imu_ = topics_->add_topic(imu_topic(config, rig), ros::kImu);
    odometry_ = topics_->add_topic("/truth/odometry", ros::kOdometry);
    if (options_.frames) tf_ = topics_->add_topic("/tf", ros::kTfMessage);
    if (options_.clock) clock_ = topics_->add_topic("/clock", ros::kClock);
    if (options_.frames) write_mounting();
  }

  void write(const Event& event) override {
    if (const auto* sample = std::get_if<ImuSample>(&event.data)) {
      dataset::encode_driver_imu(*sample, driver_, imu_frame_, message_);
      return send(imu_, sample->stamp);
    }
    const auto& scan = std::get<Scan>(event.data);
    if (custom_) {
      dataset::encode_livox_custom(scan, info_, frame_, message_);
    } else if (driver_ == dataset::Driver::kLivox) {
      dataset::encode_livox_cloud(scan, info_, frame_, message_);
    } else if (driver_ == dataset::Driver::kOuster) {
      dataset::encode_ouster_cloud(scan, info_, frame_, message_);
    } else {
      ros::encode_scan(scan, frame_, message_);
    }
    send(points_, end_of(scan));
  }

  void write_truth(const StampedPose& pose) override {
    if (options_.clock) {
      ros::encode_clock(pose.stamp, message_);
      send(clock_, pose.stamp);
    }
    ros::encode_odometry(pose, {kWorldFrame, rig_.body_frame}, message_);
    send(odometry_, pose.stamp);
    if (!options_.frames) return;
    const StampedTransform transform{pose.stamp, kWorldFrame, rig_.body_frame,
                                     pose.world_from_body};
    ros::encode_transforms(std::span(&transform, 1), message_);
    send(tf_, pose.stamp);
  }

  void finish() override { topics_->close(); }

 private:
  void write_mounting() {
    std::vector<StampedTransform> mounting{
        {Time{0}, rig_.body_frame, frame_, info_.body_from_lidar}};
    for (const ImuInfo& imu : rig_.imus) {
      mounting.push_back({Time{0}, rig_.body_frame, imu.id + "_imu", imu.body_from_imu});
    }
    const std::uint16_t topic = topics_->add_topic("/tf_static", ros::kTfMessage, true);
    ros::encode_transforms(mounting, message_);
    send(topic, Time{0});
  }

  void send(std::uint16_t topic, Time t) { topics_->write(topic, t, t, message_.bytes()); }

  Rig rig_;
  LidarInfo info_;
  dataset::Driver driver_;
  bool custom_;
  std::string frame_, imu_frame_;
  TopicOptions options_;
  std::unique_ptr<dataset::RecordingWriter> topics_;
  dataset::MessageWriter message_;
  std::uint16_t points_ = 0, imu_ = 0, odometry_ = 0, tf_ = 0, clock_ = 0;
};

}  // namespace

std::unique_ptr<Output> make_topic_output(const PluginConfig& config, const Rig& rig,
                                          std::unique_ptr<dataset::RecordingWriter> topics,
                                          const TopicOptions& options) {
  return std::make_unique<TopicOutput>(config, rig, std::move(topics), options);
}

}  // namespace lidarena::gazebo_plugin
