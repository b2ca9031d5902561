// SPDX-License-Identifier: BSD-3-Clause
#include "adapters/gazebo/output.hpp"

#ifdef LIDARENA_HAVE_ROS
#include <ros/ros.h>
#include <topic_tools/shape_shifter.h>

#include <cstring>

#include "lidarena/dataset/messages/driver_layouts.hpp"
#include "lidarena/dataset/messages/ros_messages.hpp"
#endif

namespace lidarena::gazebo_plugin {

#ifdef LIDARENA_HAVE_ROS
namespace {

/// Publisher for a message type given by name; takes serialized messages.
class BytesPublisher {
 public:
  BytesPublisher(::ros::NodeHandle& node, const std::string& topic, std::string_view type) {
    constexpr std::uint32_t kQueue = 100;
    shape_.morph(lidarena::dataset::ros::ros1_md5_of(type), lidarena::dataset::ros::ros1_name(type),
                 lidarena::dataset::ros::definition_of(type, dataset::Encoding::kRos1), "0");
    publisher_ = shape_.advertise(node, topic, kQueue);
  }
  void publish(dataset::Bytes bytes) {
    std::vector<std::uint8_t> copy(bytes.size());
    std::memcpy(copy.data(), bytes.data(), bytes.size());
    ::ros::serialization::IStream stream(copy.data(), static_cast<std::uint32_t>(copy.size()));
    shape_.read(stream);
    publisher_.publish(shape_);
  }

 private:
  topic_tools::ShapeShifter shape_;
  ::ros::Publisher publisher_;
};

class RosOutput final : public Output {
 public:
  RosOutput(const PluginConfig& config, const Rig& rig)
      : info_(rig.lidars.front()),
        driver_(config.dialect == dataset::Dialect::kDriver ? dataset::driver_of(info_)
                                                            : dataset::Driver::kUnknown),
        custom_(config.publish_pointcloud_type == 3),
        frame_(config.frame.empty() ? info_.id + "_lidar" : config.frame),
        points_(node_, points_topic(config, rig),
                custom_ ? dataset::livox_type(info_, dataset::Encoding::kRos1)
                        : lidarena::dataset::ros::kPointCloud2),
        imu_(node_, imu_topic(config, rig), lidarena::dataset::ros::kImu),
        odometry_(node_, "/truth/odometry", lidarena::dataset::ros::kOdometry) {}

  void write(const dataset::Event& event) override {
    if (const auto* sample = std::get_if<ImuSample>(&event.data)) {
      dataset::encode_driver_imu(*sample, driver_, info_.id + "_imu", message_);
      return imu_.publish(message_.bytes());
    }
    const auto& scan = std::get<Scan>(event.data);
    if (custom_) {
      dataset::encode_livox_custom(scan, info_, frame_, message_);
    } else if (driver_ == dataset::Driver::kLivox) {
      dataset::encode_livox_cloud(scan, info_, frame_, message_);
    } else if (driver_ == dataset::Driver::kOuster) {
      dataset::encode_ouster_cloud(scan, info_, frame_, message_);
    } else {
      lidarena::dataset::ros::encode_scan(scan, frame_, message_);
    }
    points_.publish(message_.bytes());
  }

  void write_truth(const StampedPose& pose) override {
    lidarena::dataset::ros::encode_odometry(pose, "world", "body", message_);
    odometry_.publish(message_.bytes());
  }

 private:
  ::ros::NodeHandle node_;
  LidarInfo info_;
  dataset::Driver driver_;
  bool custom_;
  std::string frame_;
  BytesPublisher points_, imu_, odometry_;
  dataset::MessageWriter message_{dataset::Encoding::kRos1};
};

}  // namespace

std::unique_ptr<Output> make_ros_output(const PluginConfig& config, const Rig& rig) {
  if (!::ros::isInitialized()) {
    int no_arguments = 0;
    ::ros::init(no_arguments, nullptr, "lidarena", ::ros::init_options::NoSigintHandler);
  }
  if (!::ros::master::check()) return nullptr;  // no ROS master; waiting for one would block
  return std::make_unique<RosOutput>(config, rig);
}
#else
std::unique_ptr<Output> make_ros_output(const PluginConfig&, const Rig&) { return nullptr; }
#endif

}  // namespace lidarena::gazebo_plugin
