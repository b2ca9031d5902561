// SPDX-License-Identifier: BSD-3-Clause
// A plugin of a <model>: moves it along a recorded trajectory, regardless of the physics.
#include <gazebo/common/CommonIface.hh>
#include <gazebo/common/Console.hh>
#include <gazebo/common/Events.hh>
#include <gazebo/common/Plugin.hh>
#include <gazebo/physics/physics.hh>

#include <optional>

#include "adapters/gazebo/plugin/flight_config.hpp"
#include "adapters/gazebo/plugin/sdf_config.hpp"
#include "lidarena/base/error.hpp"

namespace lidarena::gazebo_plugin {
namespace {

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
      flight_ = load_flight(config, found.empty() ? config.trajectory : found);
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
