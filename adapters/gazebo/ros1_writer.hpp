// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>

#include "lidarena/dataset/recording.hpp"

namespace lidarena::gazebo_plugin {

/// Publishes messages on ROS 1 topics. nullptr if the plugin was built without roscpp or no master
/// is running. Initializes ROS if that has not been done.
std::unique_ptr<dataset::RecordingWriter> make_ros1_writer();

}  // namespace lidarena::gazebo_plugin
