// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/sensor/lidar_shake.hpp"

#include <algorithm>

#include "lidarena/base/so3.hpp"

namespace lidarena::sensor {
namespace {

constexpr std::int64_t kNodeStep = 250'000;  // ns
constexpr int kNodesPerThrust = 20;

}  // namespace

LidarShake::LidarShake(const Vibration& vibration, const flight::Flight& flight,
                       const Pose& lidar_from_imu, Time stamp, std::int32_t last_dt_ns)
    : lidar_from_imu_(lidar_from_imu), imu_from_lidar_(lidar_from_imu.inverse()) {
  Vibration::Gains gains;
  for (int i = 0; i <= last_dt_ns / kNodeStep + 1; ++i) {
    const Time t = stamp + Time{i * kNodeStep};
    if (i % kNodesPerThrust == 0) gains = vibration.gains(relative_thrust(flight.at(t)));
    nodes_.push_back(vibration.shift(t, gains));
  }
}

Pose LidarShake::at(std::int32_t dt_ns) const {
  const auto i = std::min(static_cast<std::size_t>(dt_ns / kNodeStep), nodes_.size() - 2);
  const double h = 1e-9 * kNodeStep;
  const double x = static_cast<double>(dt_ns) / kNodeStep - static_cast<double>(i);
  const double y = 1.0 - x;
  const Vibration::Vector6 shift =  // cubic Hermite
      y * y * (1.0 + 2.0 * x) * nodes_[i].value + x * x * (3.0 - 2.0 * x) * nodes_[i + 1].value +
      h * x * y * (y * nodes_[i].rate - x * nodes_[i + 1].rate);
  return lidar_from_imu_ * make_pose(so3::exp(shift.tail<3>()), shift.head<3>()) * imu_from_lidar_;
}

}  // namespace lidarena::sensor
