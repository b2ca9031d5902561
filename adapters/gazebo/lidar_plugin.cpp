// SPDX-License-Identifier: BSD-3-Clause
// A plugin of a <sensor type="ray">: replaces it by a Lidarena sensor.
#include <gazebo/common/Console.hh>
#include <gazebo/common/Events.hh>
#include <gazebo/common/Plugin.hh>
#include <gazebo/physics/physics.hh>
#include <gazebo/sensors/Sensor.hh>

#include <chrono>
#include <csignal>
#include <optional>
#include <vector>

#include "adapters/gazebo/gazebo_scene.hpp"
#include "adapters/gazebo/plugin/output.hpp"
#include "adapters/gazebo/plugin/plugin_config.hpp"
#include "adapters/gazebo/plugin/sdf_config.hpp"
#include "adapters/gazebo/plugin/sensor_run.hpp"
#include "adapters/gazebo/ros1_writer.hpp"
#include "lidarena/base/error.hpp"
#include "lidarena/sensor/simulate.hpp"

namespace lidarena::gazebo_plugin {
namespace {

Time to_time(const ::gazebo::common::Time& t) {
  return std::chrono::seconds(t.sec) + std::chrono::nanoseconds(t.nsec);
}

SensorElement describe(const ::gazebo::sensors::Sensor& sensor, const sdf::ElementPtr& plugin) {
  SensorElement element;
  element.update_rate = sensor.UpdateRate();
  element.body_from_sensor = to_pose(sensor.Pose());
  // The Livox plugins have their own <ray> inside <plugin>.
  for (const sdf::ElementPtr& owner : {plugin->GetParent(), plugin}) {
    if (owner) read_range(owner, element);
  }
  return element;
}

Console console() {
  return {[](const std::string& line) { gzmsg << "lidarena: " << line << "\n"; },
          [](const std::string& line) { gzerr << "lidarena: " << line << "\n"; }};
}

}  // namespace

class LidarPlugin : public ::gazebo::SensorPlugin {
 public:
  void Load(::gazebo::sensors::SensorPtr sensor, sdf::ElementPtr sdf) override {
    const std::string place = "plugin of " + sensor->ScopedName();
    try {
      load(*sensor, sdf, place);
    } catch (const Error& error) {
      gzerr << "lidarena: " << error.what() << "; the sensor is switched off\n";
    }
    sensor->SetActive(false);  // Gazebo's own rays are not needed
  }

 private:
  void load(const ::gazebo::sensors::Sensor& sensor, const sdf::ElementPtr& sdf,
            const std::string& place) {
    config_ = read_sdf_config<PluginConfig>(sdf, place);
    const sensor::SensorConfig sensor_config = sensor_of(config_, describe(sensor, sdf), place);
    world_ = ::gazebo::physics::get_world(sensor.WorldName());
    link_ = boost::dynamic_pointer_cast<::gazebo::physics::Link>(
        world_->EntityByName(sensor.ParentName()));
    if (!link_) throw InputError(place, "the sensor does not belong to a link");
    run_.emplace(config_, sensor_config, make_outputs(sensor::make_rig({sensor_config})),
                 console());
    scene_ = std::make_unique<GazeboScene>(world_, config_.geometry, link_.get());
    update_ = ::gazebo::event::Events::ConnectWorldUpdateEnd([this] { step(); });
  }

  std::vector<std::unique_ptr<Output>> make_outputs(const Rig& rig) const {
    std::vector<std::unique_ptr<Output>> outputs;
    if (!config_.record.empty()) outputs.push_back(make_recorder(config_, rig, "gazebo"));
    if (config_.gazebo) outputs.push_back(make_transport_output(config_, rig));
    if (!config_.ros) return outputs;
    if (auto topics = make_ros1_writer()) {
      outputs.push_back(make_topic_output(config_, rig, std::move(topics)));
    }
    return outputs;
  }

  /// Called after every physics step: passes the poses to the sensor.
  void step() {
    if (run_->is_finished()) return;
    const StampedPose body{to_time(world_->SimTime()), to_pose(link_->WorldPose())};
    if (auto rebuilt = scene_->rebuilt_if_changed()) moving_world_ = std::move(rebuilt);
    run_->step(body, moving_world_, scene_->poses());
    if (run_->is_finished() && config_.stop) std::raise(SIGINT);  // like Ctrl-C: a clean shutdown
  }

  PluginConfig config_;
  ::gazebo::physics::WorldPtr world_;
  ::gazebo::physics::LinkPtr link_;
  std::unique_ptr<GazeboScene> scene_;
  std::shared_ptr<world::MovingWorld> moving_world_;
  std::optional<SensorRun> run_;
  ::gazebo::event::ConnectionPtr update_;
};

GZ_REGISTER_SENSOR_PLUGIN(LidarPlugin)

}  // namespace lidarena::gazebo_plugin
