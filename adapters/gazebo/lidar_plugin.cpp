// SPDX-License-Identifier: BSD-3-Clause
// A plugin of a <sensor type="ray">: replaces it by a Lidarena sensor.
#include <time.h>
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
#include "adapters/gazebo/output.hpp"
#include "adapters/gazebo/plugin_config.hpp"
#include "adapters/gazebo/sdf_config.hpp"
#include "adapters/gazebo/step_thread.hpp"
#include "lidarena/base/error.hpp"
#include "lidarena/sensor/simulate.hpp"
#include "lidarena/sensor/stepped_sensor.hpp"

namespace lidarena::gazebo_plugin {
namespace {

Time to_time(const ::gazebo::common::Time& t) {
  return std::chrono::seconds(t.sec) + std::chrono::nanoseconds(t.nsec);
}

double thread_cpu_seconds() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

double process_cpu_seconds() {
  timespec t{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

SensorElement describe(const ::gazebo::sensors::Sensor& sensor, const sdf::ElementPtr& plugin) {
  SensorElement element;
  element.update_rate = sensor.UpdateRate();
  element.body_from_sensor = to_pose(sensor.Pose());
  // The Livox plugins have their own <ray> inside <plugin>.
  for (const sdf::ElementPtr& owner : {plugin->GetParent(), plugin}) {
    if (!owner || !owner->HasElement("ray")) continue;
    const auto ray = owner->GetElement("ray");
    if (!ray->HasElement("range")) continue;
    const auto range = ray->GetElement("range");
    if (range->HasElement("min"))
      element.min_range = std::stod(range->GetElement("min")->GetValue()->GetAsString());
    if (range->HasElement("max"))
      element.max_range = std::stod(range->GetElement("max")->GetValue()->GetAsString());
  }
  return element;
}

}  // namespace

class LidarPlugin : public ::gazebo::SensorPlugin {
 public:
  ~LidarPlugin() override { finish(); }

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
    sensor_config_ = sensor_of(config_, describe(sensor, sdf), place);
    world_ = ::gazebo::physics::get_world(sensor.WorldName());
    link_ = boost::dynamic_pointer_cast<::gazebo::physics::Link>(
        world_->EntityByName(sensor.ParentName()));
    if (!link_) throw InputError(place, "the sensor does not belong to a link");
    const Rig rig = sensor::make_rig({sensor_config_});
    if (!config_.record.empty()) outputs_.push_back(make_recorder(config_, rig));
    if (config_.gazebo) outputs_.push_back(make_gazebo_output(config_, rig));
    if (config_.ros) {
      if (auto ros = make_ros_output(config_, rig)) outputs_.push_back(std::move(ros));
    }
    scene_ = std::make_unique<GazeboScene>(world_, config_.geometry, link_.get());
    if (config_.threads > 0) thread_.emplace();
    update_ = ::gazebo::event::Events::ConnectWorldUpdateEnd([this] { step(); });
  }

  /// Called after every physics step: passes the poses to the sensor.
  void step() {
    if (is_done_) return;
    const StampedPose pose{to_time(world_->SimTime()), to_pose(link_->WorldPose())};
    if (auto rebuilt = scene_->rebuilt_if_changed()) moving_world_ = std::move(rebuilt);
    if (start_ < Time{0}) {
      start_ = pose.stamp;
      start_wall_ = std::chrono::steady_clock::now();
      start_cpu_ = process_cpu_seconds();
    }
    if (thread_) {
      thread_->add([this, pose, world = moving_world_, moved = scene_->poses()] {
        measure(pose, *world, moved);
      });
    } else {
      measure(pose, *moving_world_, scene_->poses());
    }
    const bool ends =
        config_.record_seconds > 0.0 && pose.stamp - start_ >= from_seconds(config_.record_seconds);
    if (!ends) return;
    finish();
    if (config_.stop) std::raise(SIGINT);  // like Ctrl-C: the server shuts down cleanly
  }

  void measure(const StampedPose& pose, world::MovingWorld& world, const std::vector<Pose>& moved) {
    const double begin = thread_cpu_seconds();
    world.move(moved);
    if (!sensor_) {
      sensor_.emplace(sensor_config_, sensor_config_.name, config_.seed, config_.noise, pose.stamp);
    }
    events_.clear();
    sensor_->step(world, pose, events_);
    cast_seconds_ += thread_cpu_seconds() - begin;
    for (const auto& output : outputs_) {
      output->write_truth(pose);
      for (const dataset::Event& event : events_) output->write(event);
    }
    output_seconds_ += thread_cpu_seconds() - begin;
  }

  void finish() {
    if (is_done_) return;
    is_done_ = true;
    if (thread_) thread_->drain();
    try {
      for (const auto& output : outputs_) output->finish();
    } catch (const Error& error) {
      gzerr << "lidarena: " << error.what() << "\n";
    }
    if (!sensor_) return;
    const double seconds = to_seconds(to_time(world_->SimTime()) - start_);
    const double wall =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - start_wall_).count();
    gzmsg << "lidarena: " << sensor_config_.name << " cast " << sensor_->rays() << " rays in "
          << seconds << " simulated seconds. CPU: "
          << 1e9 * cast_seconds_ / static_cast<double>(sensor_->rays())
          << " ns per ray; per simulated second " << cast_seconds_ / seconds << " s to cast, "
          << (output_seconds_ - cast_seconds_) / seconds
          << " s to write and publish, whole process "
          << (process_cpu_seconds() - start_cpu_) / seconds << " s. Real-time factor "
          << seconds / wall << "\n";
  }

  PluginConfig config_;
  sensor::SensorConfig sensor_config_;
  ::gazebo::physics::WorldPtr world_;
  ::gazebo::physics::LinkPtr link_;
  std::unique_ptr<GazeboScene> scene_;
  std::shared_ptr<world::MovingWorld> moving_world_;
  std::optional<sensor::SteppedSensor> sensor_;
  std::vector<std::unique_ptr<Output>> outputs_;
  std::vector<dataset::Event> events_;
  Time start_{-1};
  bool is_done_ = false;
  std::chrono::steady_clock::time_point start_wall_;
  double start_cpu_ = 0.0;
  double cast_seconds_ = 0.0, output_seconds_ = 0.0;  ///< CPU; the second includes the first
  std::optional<StepThread> thread_;
  ::gazebo::event::ConnectionPtr update_;
};

GZ_REGISTER_SENSOR_PLUGIN(LidarPlugin)

}  // namespace lidarena::gazebo_plugin
