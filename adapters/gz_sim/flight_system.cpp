// SPDX-License-Identifier: BSD-3-Clause
// A system plugin of a <model>: moves it along a recorded trajectory, regardless of the physics.
#include <chrono>
#include <memory>
#include <optional>

#include "adapters/gazebo/plugin/flight_config.hpp"
#include "adapters/gazebo/plugin/sdf_config.hpp"
#include "adapters/gz_sim/gz_sim.hpp"
#include "adapters/gz_sim/register.hpp"
#include "lidarena/base/error.hpp"

namespace lidarena::gz_sim_plugin {

class FlightSystem : public sim::System,
                     public sim::ISystemConfigure,
                     public sim::ISystemPreUpdate {
 public:
  void Configure(const sim::Entity& entity, const std::shared_ptr<const sdf::Element>& sdf,
                 sim::EntityComponentManager& ecm, sim::EventManager&) override {
    model_ = entity;
    const std::string name = sim::scopedName(entity, ecm, "::", false);
    try {
      configure(sdf, ecm, "flight plugin of " + name);
    } catch (const Error& error) {
      print_error(std::string(error.what()) + "; " + name + " does not move");
    }
  }

  /// The pose at the end of the step that begins.
  void PreUpdate(const sim::UpdateInfo& info, sim::EntityComponentManager& ecm) override {
    if (!flight_ || info.paused || !ecm.HasEntity(model_)) return;
    if (!gravity_ && !read_gravity(ecm)) return;
    const gz::math::Pose3d pose = to_gz(flight_->pose_at(info.simTime));
    // The physics is told the pose, for collisions; the component has it even without physics.
    ecm.SetComponentData<components::Pose>(model_, pose);
    ecm.SetComponentData<components::WorldPoseCmd>(model_, pose);
    hold(pose, std::chrono::duration<double>(info.dt).count(), ecm);
  }

 private:
  void configure(const std::shared_ptr<const sdf::Element>& sdf,
                 const sim::EntityComponentManager& ecm, const std::string& place) {
    const auto* is_static = ecm.Component<components::Static>(model_);
    if (is_static == nullptr) throw InputError(place, "does not belong to a model");
    if (is_static->Data()) throw InputError(place, "the model is static", "remove its <static>");
    const auto config =
        gazebo_plugin::read_sdf_config<gazebo_plugin::FlightPluginConfig>(sdf, place);
    const std::string found = gz::common::findFile(config.trajectory);
    flight_ = load_flight(config, found.empty() ? config.trajectory : found);
  }

  /// A model belongs to its world only after its plugins were configured. Ends the flight of a
  /// model inside another one, which the physics cannot place.
  bool read_gravity(const sim::EntityComponentManager& ecm) {
    const auto* gravity = ecm.Component<components::Gravity>(ecm.ParentEntity(model_));
    if (gravity != nullptr) {
      gravity_ = gravity->Data();
      return true;
    }
    print_error(sim::scopedName(model_, ecm, "::", false) +
                " does not move: it is inside another model");
    flight_.reset();
    return false;
  }

  /// Commands the velocity that gravity cancels within the step: the physics leaves the body where
  /// it was put. Velocities are commanded in the model's frame.
  void hold(const gz::math::Pose3d& pose, double dt_s, sim::EntityComponentManager& ecm) const {
    const gz::math::Vector3d lift = pose.Rot().RotateVectorReverse(*gravity_ * -dt_s);
    ecm.SetComponentData<components::LinearVelocityCmd>(model_, lift);
    ecm.SetComponentData<components::AngularVelocityCmd>(model_, gz::math::Vector3d::Zero);
  }

  sim::Entity model_ = sim::kNullEntity;
  std::optional<gz::math::Vector3d> gravity_;  ///< m/s^2, world frame; read at the first step
  std::optional<flight::ReplayFlight> flight_;
};

}  // namespace lidarena::gz_sim_plugin

LIDARENA_ADD_PLUGIN(lidarena::gz_sim_plugin::FlightSystem, lidarena::gz_sim_plugin::sim::System,
                    lidarena::gz_sim_plugin::sim::ISystemConfigure,
                    lidarena::gz_sim_plugin::sim::ISystemPreUpdate)
LIDARENA_ADD_PLUGIN_ALIAS(lidarena::gz_sim_plugin::FlightSystem, "lidarena::Flight")
