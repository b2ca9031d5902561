// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>

#include "lidarena/dataset/trajectories/trajectory_io.hpp"

namespace lidarena::dataset {

/// Reads the poses on a topic of an MCAP file or a ROS 1 bag: nav_msgs/Odometry,
/// geometry_msgs/PoseStamped, PoseWithCovarianceStamped or TransformStamped, with the stamps of
/// their headers. If `topic` is empty, there must be only one topic of these types. Throws
/// InputError naming file, topic and message: no such topic or several, stamps that go
/// back, a pose that is not finite or whose quaternion's norm is not 1, a file that is cut off.
FramedTrajectory read_recorded_trajectory(const std::filesystem::path& file,
                                          const std::string& topic = {});

}  // namespace lidarena::dataset
