// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <string>

#include "adapters/gazebo/plugin/plugin_config.hpp"
#include "lidarena/base/event.hpp"
#include "lidarena/base/rig.hpp"
#include "lidarena/base/trajectory.hpp"
#include "lidarena/dataset/recording.hpp"

namespace lidarena::gazebo_plugin {

/// Destination of the measurements of a plugin.
class Output {
 public:
  virtual ~Output() = default;
  virtual void write(const Event& event) = 0;
  /// True pose of the link that carries the sensor; called at every step.
  virtual void write_truth(const StampedPose&) {}
  /// Completes the output; no further calls follow.
  virtual void finish() {}
};

/// Writes a dataset folder, or a .bag or .mcap file, without ROS. `source`: the simulator, for the
/// manifest. Throws InputError if it cannot be created.
std::unique_ptr<Output> make_recorder(const PluginConfig& config, const Rig& rig,
                                      const std::string& source);

/// What make_topic_output() sends besides the measurements and the true poses.
struct TopicOptions {
  bool frames = false;  ///< the true poses also as /tf, the mounting as /tf_static
  bool clock = false;   ///< the simulator's time as /clock, at every step
};
/// Writes the messages of the sensor's ROS driver to `topics`, which sends them. The messages are
/// byte for byte those that the recorder writes into recordings of the same encoding.
std::unique_ptr<Output> make_topic_output(const PluginConfig& config, const Rig& rig,
                                          std::unique_ptr<dataset::RecordingWriter> topics,
                                          const TopicOptions& options = {});

/// Publishes through Gazebo's own transport (ignition transport, Gazebo Transport):
/// PointCloudPacked (x y z intensity t ring; t in ns since the stamp) and IMU.
std::unique_ptr<Output> make_transport_output(const PluginConfig& config, const Rig& rig);

/// Topics of the plugin's LiDAR and of its IMU, and the frame of its points.
std::string points_topic(const PluginConfig& config, const Rig& rig);
std::string imu_topic(const PluginConfig& config, const Rig& rig);
std::string points_frame(const PluginConfig& config, const Rig& rig);

}  // namespace lidarena::gazebo_plugin
