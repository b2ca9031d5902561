// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/estimation/inertial_prediction.hpp"

namespace lidarena::estimation {

ImuTrack integrate(const std::vector<ImuInterval>& intervals, const NavState& state,
                   const ImuModel& imu, Preintegration& sum) {
  ImuTrack track;
  for (const ImuInterval& interval : intervals) {
    const NavState now = sum.predict(state, imu.gravity);
    const Eigen::Matrix3d rotation = now.world_from_imu.linear();
    Eigen::Vector3d accel = imu.accel_scale * interval.accel;
    if (interval.gap)  // coast with constant velocity
      accel = state.bias.accel - rotation.transpose() * imu.gravity;
    track.push_back({interval.begin, now.world_from_imu, now.velocity,
                     rotation * (accel - state.bias.accel) + imu.gravity,
                     interval.gyro - state.bias.gyro});
    sum.integrate(interval.gyro, accel, interval.seconds(),
                  interval.gap ? kCoastingNoise : imu.noise);
  }
  return track;
}

}  // namespace lidarena::estimation
