// SPDX-License-Identifier: BSD-3-Clause
// A plugin of a <model>: moves it along a recorded trajectory, regardless of the physics.
#include <gazebo/common/CommonIface.hh>
#include <gazebo/common/Console.hh>
#include <gazebo/common/Events.hh>
#include <gazebo/common/Plugin.hh>
#include <gazebo/physics/physics.hh>

#include <optional>

#include "adapters/gazebo/sdf_config.hpp"
#include "lidarena/base/error.hpp"
#include "lidarena/flight/recording.hpp"
#include "lidarena/flight/replay_flight.hpp"

namespace lidarena::gazebo_plugin {
namespace {

struct FlightPluginConfig {
  std::string trajectory;
  double thin_s = 0.01;

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("trajectory", self.trajectory, "",
      "TUM file (t x y z qx qy qz qw) of the model's frame, also searched in "
      "GAZEBO_RESOURCE_PATH; its first pose is at simulated time 0");
    v("thin_s", self.thin_s, "s",
      "minimum time between poses, closer ones are left out: their rounding would disturb the IMU",
      at_least(0));
  }
};

ignition::math::Pose3d to_gazebo(const Pose& pose) {
  const Eigen::Quaterniond q(pose.linear());
  const Eigen::Vector3d p = pose.translation();
  return {p.x(), p.y(), p.z(), q.w(), q.x(), q.y(), q.z()};
}

}  // namespace

class FlightPlugin : public ::gazebo::ModelPlugin {
 public:
  void Load(::gazebo::physics::ModelPtr model, sdf::ElementPtr sdf) override {
    try {
      const auto config =
          read_sdf_config<FlightPluginConfig>(sdf, "flight plugin of " + model->GetName());
      const std::string found = ::gazebo::common::find_file(config.trajectory);
      const std::string& file = found.empty() ? config.trajectory : found;
      flight_.emplace(flight::thinned(flight::read_recording(file), config.thin_s), file);
    } catch (const Error& error) {
      gzerr << "lidarena: " << error.what() << "; " << model->GetName() << " does not move\n";
      return;
    }
    model_ = model;
    model_->SetGravityMode(false);
    fly(Time{0});
    update_ = ::gazebo::event::Events::ConnectWorldUpdateBegin(
        [this](const ::gazebo::common::UpdateInfo& info) {
          fly(std::chrono::seconds(info.simTime.sec) + std::chrono::nanoseconds(info.simTime.nsec));
        });
  }

 private:
  void fly(Time t) {
    model_->SetWorldPose(to_gazebo(flight_->pose_at(t)));
    model_->SetWorldTwist(ignition::math::Vector3d::Zero, ignition::math::Vector3d::Zero);
  }

  ::gazebo::physics::ModelPtr model_;
  std::optional<flight::ReplayFlight> flight_;
  ::gazebo::event::ConnectionPtr update_;
};

GZ_REGISTER_MODEL_PLUGIN(FlightPlugin)

}  // namespace lidarena::gazebo_plugin
