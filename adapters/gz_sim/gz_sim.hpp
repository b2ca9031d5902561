// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// The simulator's headers and names in the version that the plugins are built for. LIDARENA_GZ_SIM
/// is defined for Gazebo Harmonic and later (gz::sim); without it they are those of Fortress
/// (ignition::gazebo). The plugins are written in terms of the two aliases at the end.
#ifdef LIDARENA_GZ_SIM
#include <gz/common/Console.hh>
#include <gz/common/Mesh.hh>
#include <gz/common/MeshManager.hh>
#include <gz/common/SubMesh.hh>
#include <gz/common/Util.hh>
#include <gz/math/Pose3.hh>
#include <gz/sim/EntityComponentManager.hh>
#include <gz/sim/EventManager.hh>
#include <gz/sim/Events.hh>
#include <gz/sim/System.hh>
#include <gz/sim/Util.hh>
#include <gz/sim/components/AngularVelocityCmd.hh>
#include <gz/sim/components/Collision.hh>
#include <gz/sim/components/Geometry.hh>
#include <gz/sim/components/Gravity.hh>
#include <gz/sim/components/LinearVelocityCmd.hh>
#include <gz/sim/components/Link.hh>
#include <gz/sim/components/Model.hh>
#include <gz/sim/components/Name.hh>
#include <gz/sim/components/ParentEntity.hh>
#include <gz/sim/components/Pose.hh>
#include <gz/sim/components/PoseCmd.hh>
#include <gz/sim/components/Static.hh>
#include <gz/sim/components/Visual.hh>
#include <gz/sim/components/World.hh>
#define LIDARENA_CONSOLE_MESSAGE gzmsg
#define LIDARENA_CONSOLE_WARNING gzwarn
#define LIDARENA_CONSOLE_ERROR gzerr
#else
#include <ignition/common/Console.hh>
#include <ignition/common/Mesh.hh>
#include <ignition/common/MeshManager.hh>
#include <ignition/common/SubMesh.hh>
#include <ignition/common/Util.hh>
#include <ignition/gazebo/EntityComponentManager.hh>
#include <ignition/gazebo/EventManager.hh>
#include <ignition/gazebo/Events.hh>
#include <ignition/gazebo/System.hh>
#include <ignition/gazebo/Util.hh>
#include <ignition/gazebo/components/AngularVelocityCmd.hh>
#include <ignition/gazebo/components/Collision.hh>
#include <ignition/gazebo/components/Geometry.hh>
#include <ignition/gazebo/components/Gravity.hh>
#include <ignition/gazebo/components/LinearVelocityCmd.hh>
#include <ignition/gazebo/components/Link.hh>
#include <ignition/gazebo/components/Model.hh>
#include <ignition/gazebo/components/Name.hh>
#include <ignition/gazebo/components/ParentEntity.hh>
#include <ignition/gazebo/components/Pose.hh>
#include <ignition/gazebo/components/PoseCmd.hh>
#include <ignition/gazebo/components/Static.hh>
#include <ignition/gazebo/components/Visual.hh>
#include <ignition/gazebo/components/World.hh>
#include <ignition/math/Pose3.hh>
#define LIDARENA_CONSOLE_MESSAGE ignmsg
#define LIDARENA_CONSOLE_WARNING ignwarn
#define LIDARENA_CONSOLE_ERROR ignerr
#endif

#include <string>

#include "lidarena/base/pose.hpp"

namespace lidarena::gz_sim_plugin {

#ifdef LIDARENA_GZ_SIM
namespace gz = ::gz;
namespace sim = ::gz::sim;
#else
namespace gz = ::ignition;
namespace sim = ::ignition::gazebo;
#endif
namespace components = sim::components;

inline void print_message(const std::string& line) {
  LIDARENA_CONSOLE_MESSAGE << "lidarena: " << line << "\n";
}
inline void print_warning(const std::string& line) {
  LIDARENA_CONSOLE_WARNING << "lidarena: " << line << "\n";
}
inline void print_error(const std::string& line) {
  LIDARENA_CONSOLE_ERROR << "lidarena: " << line << "\n";
}

inline Eigen::Vector3d to_vector(const gz::math::Vector3d& v) { return {v.X(), v.Y(), v.Z()}; }

inline Pose to_pose(const gz::math::Pose3d& pose) {
  const auto& q = pose.Rot();
  return make_pose(Eigen::Quaterniond(q.W(), q.X(), q.Y(), q.Z()), to_vector(pose.Pos()));
}

inline gz::math::Pose3d to_gz(const Pose& pose) {
  const Eigen::Quaterniond q(pose.linear());
  const Eigen::Vector3d p = pose.translation();
  return {p.x(), p.y(), p.z(), q.w(), q.x(), q.y(), q.z()};
}

}  // namespace lidarena::gz_sim_plugin
