// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/odometry/arena_lio/lidar_covariance.hpp"

#include "lidarena/base/so3.hpp"

namespace lidarena::odometry::arena_lio {

estimation::StateEstimate of_lidar(const estimation::StateEstimate& estimate) {
  using State = estimation::InertialState;
  const Pose& imu_from_lidar = estimate.state.imu_from_lidar;
  const Eigen::Matrix3d rotation = estimate.state.rotation();
  State::Matrix by_state = State::Matrix::Identity();
  by_state.block<3, 3>(State::kPosition, State::kRotation) =
      -rotation * so3::hat(imu_from_lidar.translation());
  by_state.block<3, 3>(State::kPosition, State::kLidarPosition) = rotation;
  by_state.block<3, 3>(State::kRotation, State::kRotation) = imu_from_lidar.linear().transpose();
  by_state.block<3, 3>(State::kRotation, State::kLidarRotation).setIdentity();
  estimation::StateEstimate of_lidar = estimate;
  of_lidar.state.nav.world_from_imu = estimate.state.world_from_lidar();
  of_lidar.covariance = by_state * estimate.covariance * by_state.transpose();
  return of_lidar;
}

}  // namespace lidarena::odometry::arena_lio
