// SPDX-License-Identifier: BSD-3-Clause
#include "tests/odometry/synthetic_room.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "lidarena/base/so3.hpp"

namespace lidarena::odometry::synthetic {

namespace {

constexpr int kRings = 64;
constexpr double kScanSeconds = 0.1;
constexpr double kImuSeconds = 0.005;
const Eigen::Vector3d kGravity(0.0, 0.0, -9.81);

const Box kRoom{{-8.0, -6.0, -2.0}, {8.0, 6.0, 2.0}};
const Box kPillars[] = {{{3.0, 3.0, -2.0}, {3.8, 4.0, 2.0}},
                        {{-5.0, 2.0, -2.0}, {-4.2, 2.8, 2.0}},
                        {{-4.0, -5.0, -2.0}, {-3.0, -4.2, 1.0}},
                        {{5.5, -3.5, -2.0}, {6.5, -2.5, 2.0}}};

Scan make_scan(const Recording& recording, std::size_t index) {
  Scan scan;
  const double start = static_cast<double>(index) * kScanSeconds;
  scan.stamp = recording.epoch + from_seconds(start);
  const CounterRandom random(recording.seed, static_cast<std::uint32_t>(index));
  const std::size_t columns = recording.points_per_scan / kRings;
  // golden ratio and its square: the beams of any number of scans divide the gaps evenly
  const auto scan_number = static_cast<double>(index);
  const double ring_shift = recording.repeating ? 0.0 : std::fmod(0.618034 * scan_number, 1.0);
  const double column_shift =
      recording.repeating ? 0.0 : std::fmod(0.381966 * scan_number * scan_number, 1.0);
  for (std::size_t i = 0; i < columns * kRings; ++i) {
    const auto column = static_cast<double>(i / kRings);
    const double ring = static_cast<double>(i % kRings) + ring_shift;
    const double seconds = kScanSeconds * column / static_cast<double>(columns);
    const double azimuth =
        -2.0 * std::numbers::pi * (column + column_shift) / static_cast<double>(columns);
    const double elevation = (ring / (kRings - 1) - 0.5) * 70.0 * std::numbers::pi / 180.0;
    const Eigen::Vector3d beam(std::cos(elevation) * std::cos(azimuth),
                               std::cos(elevation) * std::sin(azimuth), std::sin(elevation));
    const Pose room_from_lidar = recording.motion(start + seconds) * recording.body_from_lidar;
    const Eigen::Vector3d origin = room_from_lidar.translation();
    const Eigen::Vector3d direction = room_from_lidar.linear() * beam;
    const double distance = recording.scene ? recording.scene(origin, direction, start + seconds)
                                            : cast(origin, direction);
    if (!std::isfinite(distance)) continue;
    const double range = distance + recording.range_noise_m * random.normals(i)[0];
    Point point;
    point.position = (range * beam).cast<float>();
    point.dt_ns = static_cast<std::int32_t>(std::lround(seconds * 1e9));
    point.ring = static_cast<std::uint16_t>(i % kRings);
    scan.points.push_back(point);
  }
  return scan;
}

/// By central differences of the motion with steps of 1 ms, exact to about 1e-6 of rate and
/// acceleration.
ImuSample make_imu(const Recording& recording, std::size_t index) {
  constexpr double h = 1e-3;
  const double t = static_cast<double>(index) * kImuSeconds;
  const Pose before = recording.motion(t - h);
  const Pose now = recording.motion(t);
  const Pose after = recording.motion(t + h);
  const Eigen::Vector3d acceleration =
      (after.translation() - 2.0 * now.translation() + before.translation()) / (h * h);
  const auto noise = [&](double density, std::uint32_t stream) {
    const auto normals = CounterRandom(recording.seed, stream).normals(index);
    const auto more = CounterRandom(recording.seed, stream + 1).normals(index);
    return Eigen::Vector3d(density / std::sqrt(kImuSeconds) *
                           Eigen::Vector3d(normals[0], normals[1], more[0]));
  };
  // Each axis has a phase of its own.
  const auto shaken = [&](double amplitude, double phase) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (int axis = 0; recording.vibrating && axis < 3; ++axis) {
      for (const double tone_hz : {126.3, 252.6})
        sum[axis] += amplitude * std::sin(2.0 * std::numbers::pi * tone_hz * t + phase + axis);
    }
    return sum;
  };
  constexpr std::uint32_t kGyroStream = 1'000'000;  // the streams of scans are their indices
  constexpr std::uint32_t kAccelStream = 2'000'000;
  return {recording.epoch + from_seconds(t),
          so3::log(before.linear().transpose() * after.linear()) / (2.0 * h) +
              noise(recording.gyro_noise_density, kGyroStream) + shaken(0.025, 0.5),
          now.linear().transpose() * (acceleration - kGravity) +
              noise(recording.accel_noise_density, kAccelStream) + shaken(2.5, 0.0)};
}

}  // namespace

double cast(const Box& box, const Eigen::Vector3d& origin, const Eigen::Vector3d& direction) {
  const Eigen::Array3d a = (box.low - origin.array()) / direction.array();
  const Eigen::Array3d b = (box.high - origin.array()) / direction.array();
  const double enter = a.min(b).maxCoeff();
  const double leave = a.max(b).minCoeff();
  if (enter >= leave || leave <= 0.0) return std::numeric_limits<double>::infinity();
  return enter > 0.0 ? enter : leave;
}

double cast(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction) {
  double range = cast(kRoom, origin, direction);
  for (const Box& pillar : kPillars) range = std::min(range, cast(pillar, origin, direction));
  return range;
}

Pose flight(double seconds) {
  const double u = std::clamp(seconds - 1.0, 0.0, 1.0);
  // time along the curve: constant for 1 s, full rate after another second, twice differentiable
  const double tau = u * u * u - 0.5 * u * u * u * u + std::max(0.0, seconds - 2.0);
  const Eigen::Matrix3d rotation =
      so3::exp({0.0, 0.0, 0.3 + 0.9 * std::sin(0.6 * tau)}) *
      so3::exp({0.1 * std::sin(0.9 * tau), 0.08 * std::sin(1.1 * tau), 0.0});
  return make_pose(rotation, {-1.0 + 2.0 * std::sin(0.4 * tau), 2.0 * (1.0 - std::cos(0.4 * tau)),
                              0.3 * std::sin(0.7 * tau)});
}

Rig rig_of(const Recording& recording) {
  Rig rig;
  LidarInfo lidar;
  lidar.id = "lidar";
  lidar.kind = "spinning";
  lidar.rows = kRings;
  lidar.columns = static_cast<int>(recording.points_per_scan) / kRings;
  lidar.max_range_m = 50.0;
  lidar.body_from_lidar = recording.body_from_lidar;
  rig.lidars.push_back(lidar);
  ImuInfo imu;
  imu.id = "imu";
  imu.rate_hz = 1.0 / kImuSeconds;
  rig.imus.push_back(imu);
  return rig;
}

std::vector<Event> record(const Recording& recording) {
  std::vector<Event> events;
  const auto scan_count = static_cast<std::size_t>(std::lround(recording.seconds / kScanSeconds));
  std::size_t imu_index = 0;
  for (std::size_t i = 0; i < scan_count; ++i) {
    Scan scan = make_scan(recording, i);
    while (true) {
      ImuSample sample = make_imu(recording, imu_index);
      if (sample.stamp > end_of(scan)) break;
      events.push_back({"imu", sample});
      ++imu_index;
    }
    events.push_back({"lidar", std::move(scan)});
  }
  return events;
}

std::vector<Scan> scans_of(const Recording& recording) {
  std::vector<Scan> scans;
  for (Event& event : record(recording)) {
    if (auto* scan = std::get_if<Scan>(&event.data)) scans.push_back(std::move(*scan));
  }
  return scans;
}

Pose truth(const Recording& recording, Time start, Time stamp) {
  return recording.motion(to_seconds(start - recording.epoch)).inverse() *
         recording.motion(to_seconds(stamp - recording.epoch));
}

}  // namespace lidarena::odometry::synthetic
