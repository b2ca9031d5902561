// SPDX-License-Identifier: BSD-3-Clause
#include "adapters/gazebo/ros1_writer.hpp"

#ifdef LIDARENA_HAVE_ROS
#include <ros/ros.h>
#include <topic_tools/shape_shifter.h>

#include <cstring>
#include <deque>

#include "lidarena/dataset/messages/ros_messages.hpp"
#endif

namespace lidarena::gazebo_plugin {

#ifdef LIDARENA_HAVE_ROS
namespace {

/// Publisher for a message type given by name; takes serialized messages.
class BytesPublisher {
 public:
  BytesPublisher(::ros::NodeHandle& node, const std::string& topic, std::string_view type,
                 bool latched) {
    constexpr std::uint32_t kQueue = 100;
    shape_.morph(lidarena::dataset::ros::ros1_md5_of(type), lidarena::dataset::ros::ros1_name(type),
                 lidarena::dataset::ros::definition_of(type, dataset::Encoding::kRos1),
                 latched ? "1" : "0");
    publisher_ = shape_.advertise(node, topic, kQueue, latched);
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

class Ros1Writer final : public dataset::RecordingWriter {
 public:
  dataset::Encoding encoding() const override { return dataset::Encoding::kRos1; }
  std::uint16_t add_topic(const std::string& name, std::string_view type, bool latched) override {
    publishers_.emplace_back(node_, name, type, latched);
    info_.topics.push_back({name, std::string(type), "ros1", 0});
    return static_cast<std::uint16_t>(publishers_.size() - 1);
  }
  void write(std::uint16_t topic, Time, Time, dataset::Bytes message) override {
    publishers_.at(topic).publish(message);
    ++info_.topics[topic].message_count;
    ++info_.message_count;
  }
  dataset::RecordingInfo info() const override { return info_; }
  void close() override {}

 private:
  ::ros::NodeHandle node_;
  std::deque<BytesPublisher> publishers_;
  dataset::RecordingInfo info_;
};

}  // namespace

std::unique_ptr<dataset::RecordingWriter> make_ros1_writer() {
  if (!::ros::isInitialized()) {
    int no_arguments = 0;
    ::ros::init(no_arguments, nullptr, "lidarena", ::ros::init_options::NoSigintHandler);
  }
  if (!::ros::master::check()) return nullptr;  // no ROS master; waiting for one would block
  return std::make_unique<Ros1Writer>();
}
#else
std::unique_ptr<dataset::RecordingWriter> make_ros1_writer() { return nullptr; }
#endif

}  // namespace lidarena::gazebo_plugin
