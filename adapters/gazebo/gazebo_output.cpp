// SPDX-License-Identifier: BSD-3-Clause
#include <ignition/msgs/imu.pb.h>
#include <ignition/msgs/pointcloud_packed.pb.h>

#include <cstring>
#include <ignition/transport/Node.hh>

#include "adapters/gazebo/output.hpp"

namespace lidarena::gazebo_plugin {
namespace {

constexpr std::int64_t kSecond = 1'000'000'000;

template <class Message>
void stamp(Message& message, Time t) {
  message.mutable_header()->mutable_stamp()->set_sec(t.count() / kSecond);
  message.mutable_header()->mutable_stamp()->set_nsec(static_cast<int>(t.count() % kSecond));
}

ignition::msgs::PointCloudPacked packed(const Scan& scan) {
  using Field = ignition::msgs::PointCloudPacked::Field;
  constexpr std::uint32_t kStep = 24;
  ignition::msgs::PointCloudPacked message;
  stamp(message, scan.stamp);
  const auto add = [&](const char* name, std::uint32_t offset, Field::DataType type) {
    Field* field = message.add_field();
    field->set_name(name);
    field->set_offset(offset);
    field->set_datatype(type);
    field->set_count(1);
  };
  add("x", 0, Field::FLOAT32);
  add("y", 4, Field::FLOAT32);
  add("z", 8, Field::FLOAT32);
  add("intensity", 12, Field::FLOAT32);
  add("t", 16, Field::UINT32);
  add("ring", 20, Field::UINT16);
  message.set_height(1);
  message.set_width(static_cast<std::uint32_t>(scan.points.size()));
  message.set_point_step(kStep);
  message.set_row_step(static_cast<std::uint32_t>(kStep * scan.points.size()));
  message.set_is_dense(true);
  std::string& data = *message.mutable_data();
  data.resize(kStep * scan.points.size());
  char* at = data.data();
  for (const Point& point : scan.points) {
    std::memcpy(at, point.position.data(), 12);
    std::memcpy(at + 12, &point.intensity, 4);
    std::memcpy(at + 16, &point.dt_ns, 4);
    std::memcpy(at + 20, &point.ring, 2);
    at += kStep;
  }
  return message;
}

class GazeboOutput final : public Output {
 public:
  GazeboOutput(const PluginConfig& config, const Rig& rig)
      : points_(node_.Advertise<ignition::msgs::PointCloudPacked>(points_topic(config, rig))),
        imu_(node_.Advertise<ignition::msgs::IMU>(imu_topic(config, rig))) {}

  void write(const dataset::Event& event) override {
    if (const auto* scan = std::get_if<Scan>(&event.data)) {
      points_.Publish(packed(*scan));
      return;
    }
    const auto& sample = std::get<ImuSample>(event.data);
    ignition::msgs::IMU message;
    stamp(message, sample.stamp);
    const auto put = [](const Eigen::Vector3d& v, ignition::msgs::Vector3d& out) {
      out.set_x(v.x());
      out.set_y(v.y());
      out.set_z(v.z());
    };
    put(sample.gyro, *message.mutable_angular_velocity());
    put(sample.accel, *message.mutable_linear_acceleration());
    imu_.Publish(message);
  }

 private:
  ignition::transport::Node node_;
  ignition::transport::Node::Publisher points_, imu_;
};

}  // namespace

std::unique_ptr<Output> make_gazebo_output(const PluginConfig& config, const Rig& rig) {
  return std::make_unique<GazeboOutput>(config, rig);
}

}  // namespace lidarena::gazebo_plugin
