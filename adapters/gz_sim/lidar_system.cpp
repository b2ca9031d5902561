// SPDX-License-Identifier: BSD-3-Clause
// A system plugin of a <sensor>: simulates a Lidarena sensor in its place.
#include <optional>
#include <vector>

#include "adapters/gazebo/plugin/output.hpp"
#include "adapters/gazebo/plugin/plugin_config.hpp"
#include "adapters/gazebo/plugin/sdf_config.hpp"
#include "adapters/gazebo/plugin/sensor_run.hpp"
#include "adapters/gz_sim/gz_scene.hpp"
#include "adapters/gz_sim/register.hpp"
#include "lidarena/base/error.hpp"
#include "lidarena/sensor/simulate.hpp"

#ifdef LIDARENA_HAVE_DDS
#include "adapters/dds/live_writer.hpp"
#endif

namespace lidarena::gz_sim_plugin {
namespace {

using gazebo_plugin::Output;
using gazebo_plugin::PluginConfig;
using gazebo_plugin::SensorElement;

using ElementPtr = std::shared_ptr<const sdf::Element>;

/// Publishes through Gazebo's transport unless told otherwise; ROS 2's topics only when told.
PluginConfig defaults() {
  PluginConfig config;
  config.gazebo = true;
  config.ros = false;
  return config;
}

SensorElement describe(const gz::math::Pose3d& link_from_sensor, const ElementPtr& plugin) {
  SensorElement element;
  element.body_from_sensor = to_pose(link_from_sensor);
  const sdf::ElementPtr sensor = plugin->GetParent();
  if (!sensor) return element;
  const sdf::ElementPtr rate = gazebo_plugin::find_child(sensor, "update_rate");
  if (rate) element.update_rate = std::stod(rate->GetValue()->GetAsString());
  gazebo_plugin::read_range(sensor, element);
  return element;
}

std::vector<std::unique_ptr<Output>> make_outputs(const PluginConfig& config, const Rig& rig) {
  std::vector<std::unique_ptr<Output>> outputs;
  if (!config.record.empty()) outputs.push_back(make_recorder(config, rig, "gz_sim"));
  if (config.gazebo) outputs.push_back(make_transport_output(config, rig));
  if (!config.ros) return outputs;
#ifdef LIDARENA_HAVE_DDS
  outputs.push_back(make_topic_output(config, rig,
                                      std::make_unique<dds::LiveWriter>(dds::LiveOptions{}),
                                      {/*frames=*/true, /*clock=*/true}));
#else
  print_warning("built without DDS: nothing is published on the topics of ROS 2");
#endif
  return outputs;
}

}  // namespace

class LidarSystem : public sim::System,
                    public sim::ISystemConfigure,
                    public sim::ISystemPostUpdate {
 public:
  void Configure(const sim::Entity& entity, const ElementPtr& sdf, sim::EntityComponentManager& ecm,
                 sim::EventManager& events) override {
    const std::string place = "plugin of " + sim::scopedName(entity, ecm, "::", false);
    events_ = &events;
    try {
      configure(entity, sdf, ecm, place);
    } catch (const Error& error) {
      print_error(std::string(error.what()) + "; the sensor is switched off");
    }
  }

  /// After every physics step: passes the poses to the sensor.
  void PostUpdate(const sim::UpdateInfo& info, const sim::EntityComponentManager& ecm) override {
    if (!run_ || run_->is_finished() || info.paused) return;
    if (!ecm.HasEntity(link_)) return run_->finish();  // the model was removed
    if (auto rebuilt = scene_->rebuilt_if_changed(ecm)) world_ = std::move(rebuilt);
    const StampedPose body{info.simTime, to_pose(sim::worldPose(link_, ecm))};
    run_->step(body, world_, scene_->poses(ecm));
    if (run_->is_finished() && config_.stop) events_->Emit<sim::events::Stop>();
  }

 private:
  void configure(sim::Entity entity, const ElementPtr& sdf, const sim::EntityComponentManager& ecm,
                 const std::string& place) {
    config_ = gazebo_plugin::read_sdf_config(sdf, place, defaults());
    link_ = ecm.ParentEntity(entity);
    const auto* pose = ecm.Component<components::Pose>(entity);
    if (pose == nullptr || ecm.Component<components::Link>(link_) == nullptr) {
      throw InputError(place, "the plugin does not belong to a sensor of a link",
                       "put it into a <sensor> inside a <link>");
    }
    const sensor::SensorConfig sensor = sensor_of(config_, describe(pose->Data(), sdf), place);
    run_.emplace(config_, sensor, make_outputs(config_, sensor::make_rig({sensor})),
                 gazebo_plugin::Console{print_message, print_error});
    scene_.emplace(config_.geometry, link_);
  }

  PluginConfig config_;
  sim::EventManager* events_ = nullptr;
  sim::Entity link_ = sim::kNullEntity;
  std::optional<GzScene> scene_;
  std::shared_ptr<world::MovingWorld> world_;
  std::optional<gazebo_plugin::SensorRun> run_;
};

}  // namespace lidarena::gz_sim_plugin

LIDARENA_ADD_PLUGIN(lidarena::gz_sim_plugin::LidarSystem, lidarena::gz_sim_plugin::sim::System,
                    lidarena::gz_sim_plugin::sim::ISystemConfigure,
                    lidarena::gz_sim_plugin::sim::ISystemPostUpdate)
LIDARENA_ADD_PLUGIN_ALIAS(lidarena::gz_sim_plugin::LidarSystem, "lidarena::Lidar")
