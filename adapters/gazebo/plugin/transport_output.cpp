// SPDX-License-Identifier: BSD-3-Clause
#include <cstring>

#include "adapters/gazebo/plugin/output.hpp"
#include "adapters/gazebo/plugin/transport.hpp"

namespace lidarena::gazebo_plugin {
namespace {

constexpr std::int64_t kSecond = 1'000'000'000;

template <class Message>
void put_header(Message& message, Time t, const std::string& frame) {
  auto* header = message.mutable_header();
  header->mutable_stamp()->set_sec(t.count() / kSecond);
  header->mutable_stamp()->set_nsec(static_cast<int>(t.count() % kSecond));
  auto* entry = header->add_data();
  entry->set_key("frame_id");
  entry->add_value(frame);
}

gz_msgs::PointCloudPacked packed(const Scan& scan, const std::string& frame) {
  using Field = gz_msgs::PointCloudPacked::Field;
  constexpr std::uint32_t kStep = 24;
  gz_msgs::PointCloudPacked message;
  put_header(message, scan.stamp, frame);
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

class TransportOutput final : public Output {
 public:
  TransportOutput(const PluginConfig& config, const Rig& rig)
      : frame_(points_frame(config, rig)),
        imu_frame_(rig.lidars.front().id + "_imu"),
        points_(node_.Advertise<gz_msgs::PointCloudPacked>(points_topic(config, rig))),
        imu_(node_.Advertise<gz_msgs::IMU>(imu_topic(config, rig))) {}

  void write(const Event& event) override {
    if (const auto* scan = std::get_if<Scan>(&event.data)) {
      points_.Publish(packed(*scan, frame_));
      return;
    }
    const auto& sample = std::get<ImuSample>(event.data);
    gz_msgs::IMU message;
    put_header(message, sample.stamp, imu_frame_);
    const auto put = [](const Eigen::Vector3d& v, gz_msgs::Vector3d& out) {
      out.set_x(v.x());
      out.set_y(v.y());
      out.set_z(v.z());
    };
    put(sample.gyro, *message.mutable_angular_velocity());
    put(sample.accel, *message.mutable_linear_acceleration());
    imu_.Publish(message);
  }

 private:
  std::string frame_, imu_frame_;
  gz_transport::Node node_;
  gz_transport::Node::Publisher points_, imu_;
};

}  // namespace

std::unique_ptr<Output> make_transport_output(const PluginConfig& config, const Rig& rig) {
  return std::make_unique<TransportOutput>(config, rig);
}

}  // namespace lidarena::gazebo_plugin
