// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

#include "lidarena/base/angle.hpp"
#include "lidarena/sensor/ouster.hpp"
#include "lidarena/sensor/simulate.hpp"

namespace lidarena::sensor {
namespace {

std::string unique_name(const std::string& name, std::set<std::string>& taken) {
  std::string id = name;
  for (int copy = 2; !taken.insert(id).second; ++copy) id = name + "_" + std::to_string(copy);
  return id;
}

std::string model_name(LidarModel model) {
  for (const auto& [name, value] : enum_names(LidarModel{})) {
    if (value == model) return name;
  }
  return "unknown";
}

/// Number of columns by which each row's azimuth is ahead of the head's.
std::vector<int> ouster_pixel_shifts(int columns) {
  std::vector<int> shifts;
  for (int row = 0; row < OusterOs0Pattern::kRows; ++row) {
    const double revolutions = os0_128_row(row).azimuth_offset / (2.0 * std::numbers::pi);
    shifts.push_back(static_cast<int>(std::lround(revolutions * columns)));
  }
  return shifts;
}

bool is_a_table(LidarModel model) {
  return model == LidarModel::kLivoxCsv || model == LidarModel::kBeamTable;
}

bool spins(LidarModel model) {
  return model == LidarModel::kOusterOs0128 || model == LidarModel::kBeamTable;
}

LidarInfo describe_lidar(const SensorConfig& sensor, const std::string& id) {
  std::vector<Beam> beams;
  make_pattern(sensor)->beams(0, beams);
  int rows = 0;
  for (const Beam& beam : beams) rows = std::max(rows, beam.ring + 1);

  LidarInfo info;
  info.id = id;
  info.model = is_a_table(sensor.model) ? id : model_name(sensor.model);
  info.kind = spins(sensor.model) ? "spinning" : "rosette";
  info.rows = rows;
  info.columns = static_cast<int>(beams.size()) / rows;
  if (sensor.model == LidarModel::kOusterOs0128) {
    info.pixel_shifts = ouster_pixel_shifts(info.columns);
    info.beam_origin_m = OusterOs0Pattern::kBeamOriginRadius;
  }
  info.rate_hz = sensor.rate_hz;
  info.min_range_m = sensor.min_range_m;
  info.max_range_m = sensor.max_range_m;
  info.body_from_lidar = mounted(sensor);
  return info;
}

/// The description of the IMU that methods get, see ToldConfig.
ImuInfo describe_imu(const SensorConfig& sensor, const std::string& id) {
  const ImuConfig imu = with_error_factor(*sensor.imu);
  const ToldConfig& told = sensor.told;
  ImuInfo info;
  info.id = id;
  info.model = imu.model;
  info.rate_hz = imu.rate_hz;
  info.gyro_noise_density = told.noise_factor * imu.gyro_noise_density;
  info.accel_noise_density = told.noise_factor * imu.accel_noise_density;
  info.gyro_bias_walk = told.bias_walk_factor * imu.gyro_bias_walk;
  info.accel_bias_walk = told.bias_walk_factor * imu.accel_bias_walk;
  info.body_from_imu = mounted(sensor) * told.lidar_from_imu.value_or(imu.lidar_from_imu);
  return info;
}

}  // namespace

Pose mounted(const SensorConfig& sensor) {
  const MountConfig& mount = sensor.mount;
  Pose pose = sensor.body_from_lidar;
  if (mount.pitch_deg != 0.0 || mount.yaw_deg != 0.0) {
    const Eigen::Quaterniond turn =
        Eigen::AngleAxisd(kDegree * mount.yaw_deg, Eigen::Vector3d::UnitZ()) *
        Eigen::AngleAxisd(kDegree * mount.pitch_deg, Eigen::Vector3d::UnitY());
    pose.linear() = (turn * pose.linear()).eval();
  }
  pose.translation().z() += mount.up_m;
  return pose;
}

Rig make_rig(const std::vector<SensorConfig>& sensors) {
  Rig rig;
  std::set<std::string> taken;
  for (const SensorConfig& sensor : sensors) {
    const std::string id = unique_name(sensor.name.empty() ? "lidar" : sensor.name, taken);
    rig.lidars.push_back(describe_lidar(sensor, id));
    if (sensor.imu) rig.imus.push_back(describe_imu(sensor, id));
  }
  return rig;
}

}  // namespace lidarena::sensor
