// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <vector>

#include "lidarena/base/event.hpp"
#include "lidarena/base/rig.hpp"
#include "lidarena/base/trajectory.hpp"

/// A small synthetic flight with a LiDAR of 10 Hz and an IMU of 200 Hz that share the id "mid360":
/// every value is a smooth function of its index, so that tests and the scripts for the official
/// readers can compute it.
namespace lidarena::dataset::sample {

inline constexpr Time kStart = std::chrono::seconds(100);
inline constexpr Time kScanPeriod = std::chrono::milliseconds(100);
inline constexpr Time kImuPeriod = std::chrono::milliseconds(5);

inline Rig rig() {
  Rig rig;
  rig.body_frame = "base_link";
  LidarInfo& lidar = rig.lidars.emplace_back();
  lidar.id = "mid360";
  lidar.model = "livox_mid360";
  lidar.body_from_lidar =
      make_pose(Eigen::Quaterniond(0.5, 0.5, 0.5, 0.5), Eigen::Vector3d(0.1, -0.2, 0.3));
  ImuInfo& imu = rig.imus.emplace_back();
  imu.id = "mid360";
  imu.body_from_imu =
      make_pose(Eigen::Quaterniond::Identity(), Eigen::Vector3d(0.011, 0.02329, -0.04412));
  return rig;
}

inline Scan scan(int index, int points) {
  Scan scan;
  scan.stamp = kStart + index * kScanPeriod + Time{7};
  for (int i = 0; i < points; ++i) {
    const float angle = 0.01F * static_cast<float>(i + index);
    Point point;
    point.position = {5.0F * std::cos(angle), 5.0F * std::sin(angle), 0.1F * static_cast<float>(i)};
    point.intensity = static_cast<float>(i % 256);
    point.dt_ns = static_cast<std::int32_t>((kScanPeriod.count() - 1) * i / points);
    point.ring = static_cast<std::uint16_t>(i % 4);
    point.echo = static_cast<std::uint8_t>(i % 3);
    scan.points.push_back(point);
  }
  return scan;
}

inline ImuSample imu(int index) {
  ImuSample sample;
  sample.stamp = kStart + index * kImuPeriod;
  const double t = 0.005 * index;
  sample.gyro = {std::sin(t), 1.0 / 3.0, -t};
  sample.accel = {0.1 * t, std::cos(t), 9.80665};
  return sample;
}

inline StampedPose truth(int index) {
  const double t = 0.005 * index;
  const Eigen::Quaterniond rotation(Eigen::AngleAxisd(0.1 * t, Eigen::Vector3d::UnitZ()));
  return {kStart + index * kImuPeriod, make_pose(rotation, Eigen::Vector3d(t, 2.0 * t, 1.5))};
}

/// `scans` scans with the IMU samples around them, in the order that EventSource guarantees.
inline std::vector<Event> events(int scans, int points) {
  std::vector<Event> events;
  int next_scan = 0;
  for (int i = 0; next_scan < scans; ++i) {
    const ImuSample sample = imu(i);
    events.push_back({"mid360", sample});
    for (; next_scan < scans; ++next_scan) {
      Scan candidate = scan(next_scan, points);
      if (end_of(candidate) > sample.stamp) break;
      events.push_back({"mid360", std::move(candidate)});
    }
  }
  return events;
}

}  // namespace lidarena::dataset::sample
