// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>
#include <chrono>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "adapters/gazebo/plugin/output.hpp"
#include "adapters/gazebo/plugin/plugin_config.hpp"
#include "adapters/gazebo/plugin/step_thread.hpp"
#include "lidarena/sensor/stepped_sensor.hpp"
#include "lidarena/world/moving_world.hpp"

namespace lidarena::gazebo_plugin {

/// The simulator's console.
struct Console {
  std::function<void(const std::string& line)> message;
  std::function<void(const std::string& line)> error;
};

/// What the plugin of a sensor does at every physics step, whichever simulator it is in: it casts
/// the shots, gives measurements and true poses to the outputs, ends the recording in time, and
/// prints what all this cost.
class SensorRun {
 public:
  SensorRun(const PluginConfig& config, const sensor::SensorConfig& sensor,
            std::vector<std::unique_ptr<Output>> outputs, Console console);
  ~SensorRun() { finish(); }

  /// Advances to `body`, the body's pose after the step. `world` with the poses `moved` of its
  /// moving shapes (see MovingWorld::move) is the world at that instant. A step that takes no time,
  /// as while the simulator pauses, is ignored.
  void step(const StampedPose& body, const std::shared_ptr<world::MovingWorld>& world,
            const std::vector<Pose>& moved);
  /// Completes the outputs and prints the cost; later steps are ignored.
  void finish();
  /// By finish(), at the end of record_seconds, or after an output failed (disk full).
  bool is_finished() const { return is_finished_; }

 private:
  void start(Time now);
  void measure(const StampedPose& body, world::MovingWorld& world, const std::vector<Pose>& moved);
  void write(const StampedPose& body);
  void print_cost() const;

  PluginConfig config_;
  sensor::SensorConfig sensor_config_;
  std::vector<std::unique_ptr<Output>> outputs_;
  Console console_;
  std::optional<sensor::SteppedSensor> sensor_;
  std::vector<Event> events_;         ///< of the current step
  std::optional<Time> start_, last_;  ///< first and last step
  std::chrono::steady_clock::time_point start_wall_;
  double start_cpu_ = 0.0;                            ///< s, of the process
  double cast_seconds_ = 0.0, output_seconds_ = 0.0;  ///< CPU; the second includes the first
  bool is_finished_ = false;
  std::atomic<bool> has_failed_{false};
  std::optional<StepThread> thread_;  // the last member: it uses the others
};

}  // namespace lidarena::gazebo_plugin
