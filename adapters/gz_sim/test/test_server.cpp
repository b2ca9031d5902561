// SPDX-License-Identifier: BSD-3-Clause
#include "adapters/gz_sim/test/test_server.hpp"

#include <fmt/format.h>

#include <stdexcept>

#ifdef LIDARENA_GZ_SIM
#include <gz/msgs/boolean.pb.h>
#include <gz/msgs/entity.pb.h>
#include <gz/msgs/entity_factory.pb.h>
#include <gz/msgs/pose.pb.h>

#include <gz/sim/Server.hh>
#include <gz/sim/ServerConfig.hh>
#include <gz/transport/Node.hh>
#else
#include <ignition/msgs/boolean.pb.h>
#include <ignition/msgs/entity.pb.h>
#include <ignition/msgs/entity_factory.pb.h>
#include <ignition/msgs/pose.pb.h>

#include <ignition/gazebo/Server.hh>
#include <ignition/gazebo/ServerConfig.hh>
#include <ignition/transport/Node.hh>
#endif

#include "lidarena/dataset/messages/ros_messages.hpp"
#include "lidarena/dataset/recording.hpp"

namespace lidarena::gz_sim_test {
namespace {

#ifdef LIDARENA_GZ_SIM
namespace gz = ::gz;
namespace sim = ::gz::sim;
constexpr const char* kSystems = R"(
<plugin filename="gz-sim-physics-system" name="gz::sim::systems::Physics"/>
<plugin filename="gz-sim-user-commands-system" name="gz::sim::systems::UserCommands"/>)";
#else
namespace gz = ::ignition;
namespace sim = ::ignition::gazebo;
constexpr const char* kSystems = R"(
<plugin filename="ignition-gazebo-physics-system" name="ignition::gazebo::systems::Physics"/>
<plugin filename="ignition-gazebo-user-commands-system"
        name="ignition::gazebo::systems::UserCommands"/>)";
#endif

constexpr unsigned int kTimeout = 5000;  // ms

sim::ServerConfig config_of(const std::string& models) {
  sim::ServerConfig config;
  config.SetSdfString(R"(<?xml version="1.0"?><sdf version="1.8"><world name="test">
<gravity>0 0 -9.80665</gravity>
<physics name="step" type="ignored">
  <max_step_size>0.001</max_step_size><real_time_factor>0</real_time_factor>
</physics>)" + std::string(kSystems) +
                      models + "</world></sdf>");
  return config;
}

template <class Decode>
auto decoded(const std::filesystem::path& recording, const std::string& topic, Decode decode) {
  std::vector<decltype(decode(dataset::RecordedMessage{}))> all;
  const auto reader = dataset::open_recording(recording);
  while (const auto message = reader->next()) {
    if (message->topic == topic) all.push_back(decode(*message));
  }
  return all;
}

}  // namespace

struct TestServer::Impl {
  explicit Impl(const std::string& models) : server(config_of(models)) {
    if (!server.IterationCount()) throw std::runtime_error("the server did not load the world");
  }

  template <class Request>
  void request(const std::string& service, const Request& message) {
    gz::msgs::Boolean reply;
    bool result = false;
    if (!node.Request("/world/test/" + service, message, kTimeout, reply, result) || !result ||
        !reply.data()) {
      throw std::runtime_error("the service " + service + " failed");
    }
  }

  sim::Server server;
  gz::transport::Node node;
};

TestServer::TestServer(const std::string& models) : impl_(std::make_unique<Impl>(models)) {}
TestServer::~TestServer() = default;

void TestServer::step(unsigned int count) {
  if (!impl_->server.Run(/*blocking=*/true, count, /*paused=*/false)) {
    throw std::runtime_error("the server does not run");
  }
}

void TestServer::spawn(const std::string& model) {
  gz::msgs::EntityFactory request;
  request.set_sdf("<?xml version=\"1.0\"?><sdf version=\"1.8\">" + model + "</sdf>");
  impl_->request("create", request);
}

void TestServer::remove(const std::string& name) {
  gz::msgs::Entity request;
  request.set_name(name);
  request.set_type(gz::msgs::Entity::MODEL);
  impl_->request("remove", request);
}

void TestServer::place(const std::string& name, const Eigen::Vector3d& position) {
  gz::msgs::Pose request;
  request.set_name(name);
  request.mutable_position()->set_x(position.x());
  request.mutable_position()->set_y(position.y());
  request.mutable_position()->set_z(position.z());
  request.mutable_orientation()->set_w(1.0);
  impl_->request("set_pose", request);
}

std::string SdfPose::sdf() const {
  return fmt::format("<pose>{} {} {} {} {} {}</pose>", position.x(), position.y(), position.z(),
                     angles.x(), angles.y(), angles.z());
}

Pose SdfPose::pose() const {
  using Eigen::AngleAxisd;
  using Eigen::Vector3d;
  return make_pose(Eigen::Quaterniond(AngleAxisd(angles.z(), Vector3d::UnitZ()) *
                                      AngleAxisd(angles.y(), Vector3d::UnitY()) *
                                      AngleAxisd(angles.x(), Vector3d::UnitX())),
                   position);
}

std::string model(const std::string& name, const SdfPose& pose, const std::string& content,
                  bool moves) {
  return fmt::format(
      "<model name=\"{}\"><static>{}</static>{}<link name=\"link\">{}</link></model>", name, !moves,
      pose.sdf(), content);
}

std::string shape(const std::string& geometry, const std::string& kind) {
  return fmt::format("<{0} name=\"{0}\"><geometry>{1}</geometry></{0}>", kind, geometry);
}

std::string sensor(const SdfPose& pose, const std::string& elements) {
  return fmt::format(
      "<sensor name=\"lidar\" type=\"custom\">{}"
      "<plugin filename=\"LidarenaGzLidar\" name=\"lidarena::Lidar\">{}</plugin></sensor>",
      pose.sdf(), elements);
}

std::vector<Scan> scans_in(const std::filesystem::path& recording, const std::string& id) {
  return decoded(recording, "/" + id + "/points", [](const dataset::RecordedMessage& message) {
    return dataset::ros::decode_scan(message.data, message.topic, message.encoding);
  });
}

std::vector<ImuSample> samples_in(const std::filesystem::path& recording, const std::string& id) {
  return decoded(recording, "/" + id + "/imu", [](const dataset::RecordedMessage& message) {
    return dataset::ros::decode_imu(message.data, message.topic, message.encoding);
  });
}

}  // namespace lidarena::gz_sim_test
