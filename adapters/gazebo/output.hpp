// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <string>

#include "adapters/gazebo/plugin_config.hpp"
#include "lidarena/base/rig.hpp"
#include "lidarena/base/trajectory.hpp"
#include "lidarena/dataset/event.hpp"

namespace lidarena::gazebo_plugin {

/// Destination of the measurements of a plugin.
class Output {
 public:
  virtual ~Output() = default;
  virtual void write(const dataset::Event& event) = 0;
  /// True pose of the link that carries the sensor; called at every step.
  virtual void write_truth(const StampedPose&) {}
  /// Completes the output; no further calls follow.
  virtual void finish() {}
};

/// Writes a dataset folder, or a .bag or .mcap file, without ROS. Throws InputError if it cannot be
/// created.
std::unique_ptr<Output> make_recorder(const PluginConfig& config, const Rig& rig);
/// Publishes ROS 1 topics. nullptr if the plugin was built without roscpp or no master is running.
/// Initializes ROS if that has not been done. The messages are byte for byte those that the
/// recorder writes into bags.
std::unique_ptr<Output> make_ros_output(const PluginConfig& config, const Rig& rig);
/// Publishes through ignition transport: ignition.msgs.PointCloudPacked (x y z intensity t ring)
/// and IMU.
std::unique_ptr<Output> make_gazebo_output(const PluginConfig& config, const Rig& rig);

/// Topics of the plugin's LiDAR and of its IMU.
std::string points_topic(const PluginConfig& config, const Rig& rig);
std::string imu_topic(const PluginConfig& config, const Rig& rig);

}  // namespace lidarena::gazebo_plugin
