// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/odometry/arena_lio/upright_world.hpp"

#include "lidarena/estimation/imu_at_rest.hpp"

namespace lidarena::odometry::arena_lio {

void UprightWorld::level(const Eigen::Vector3d& gravity, double tolerance) {
  const Eigen::Vector3d up = -(world_from_map().linear() * gravity).normalized();
  if (up.z() > 0.0 && up.head<2>().norm() < tolerance) return;
  const Eigen::Vector3d up_at_start = -(start_from_map_.linear() * gravity);
  world_from_start_.linear() = estimation::level_rotation(up_at_start);
}

}  // namespace lidarena::odometry::arena_lio
