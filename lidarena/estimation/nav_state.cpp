// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/estimation/nav_state.hpp"

#include "lidarena/base/so3.hpp"

namespace lidarena::estimation {

NavState plus(const NavState& state, const NavState::Vector& delta) {
  NavState moved = state;
  moved.world_from_imu.linear() *= so3::exp(delta.segment<3>(NavState::kRotation));
  moved.world_from_imu.translation() += delta.segment<3>(NavState::kPosition);
  moved.velocity += delta.segment<3>(NavState::kVelocity);
  moved.bias.gyro += delta.segment<3>(NavState::kGyroBias);
  moved.bias.accel += delta.segment<3>(NavState::kAccelBias);
  return moved;
}

NavState::Vector minus(const NavState& a, const NavState& b) {
  NavState::Vector delta;
  delta << so3::log(b.world_from_imu.linear().transpose() * a.world_from_imu.linear()),
      a.velocity - b.velocity, a.world_from_imu.translation() - b.world_from_imu.translation(),
      a.bias.gyro - b.bias.gyro, a.bias.accel - b.bias.accel;
  return delta;
}

}  // namespace lidarena::estimation
