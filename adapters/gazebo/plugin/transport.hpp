// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// Gazebo's messages and transport under one name: LIDARENA_GZ_SIM is defined for Gazebo Harmonic
/// and later, whose libraries are called gz; in Fortress and Gazebo Classic they are called
/// ignition.
#ifdef LIDARENA_GZ_SIM
#include <gz/msgs/imu.pb.h>
#include <gz/msgs/pointcloud_packed.pb.h>

#include <gz/transport/Node.hh>

namespace lidarena::gazebo_plugin {
namespace gz_msgs = ::gz::msgs;
namespace gz_transport = ::gz::transport;
}  // namespace lidarena::gazebo_plugin
#else
#include <ignition/msgs/imu.pb.h>
#include <ignition/msgs/pointcloud_packed.pb.h>

#include <ignition/transport/Node.hh>

namespace lidarena::gazebo_plugin {
namespace gz_msgs = ::ignition::msgs;
namespace gz_transport = ::ignition::transport;
}  // namespace lidarena::gazebo_plugin
#endif
