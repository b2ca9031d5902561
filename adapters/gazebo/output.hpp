// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <string>

#include "adapters/gazebo/plugin_config.hpp"
#include "lidarena/base/rig.hpp"
#include "lidarena/base/trajectory.hpp"
#include "lidarena/dataset/event.hpp"

namespace lidarena::gazebo_plugin {

/// Where the measurements of a plugin go.
class Output {
 public:
  virtual ~Output() = default;
  virtual void write(const Event& event) = 0;
  /// True pose of the link that carries the sensor, at every step.
  virtual void write_truth(const StampedPose&) {}
  /// Completes what is written; nothing comes after.
  virtual void finish() {}
};

/// A dataset folder, or a file .bag or .mcap, with no ROS. Throws InputError when it cannot be
/// made.
std::unique_ptr<Output> make_recorder(const PluginConfig& config, const Rig& rig);
/// ROS 1 topics; nullptr, with a line on the console, where the build has no roscpp. Starts ROS if
/// nobody did. Bytes are those that the recorder writes into bags.
std::unique_ptr<Output> make_ros_output(const PluginConfig& config, const Rig& rig);
/// Ignition transport: ignition.msgs.PointCloudPacked (x y z intensity t ring) and IMU.
std::unique_ptr<Output> make_gazebo_output(const PluginConfig& config, const Rig& rig);

/// The topics of a plugin's one LiDAR and of its IMU.
std::string points_topic(const PluginConfig& config, const Rig& rig);
std::string imu_topic(const PluginConfig& config, const Rig& rig);

}  // namespace lidarena::gazebo_plugin
