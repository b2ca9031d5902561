// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/odometry/arena_lio/initialization.hpp"

#include <algorithm>
#include <cmath>

#include "lidarena/base/so3.hpp"

namespace lidarena::odometry::arena_lio {
namespace {

using State = estimation::InertialState;

constexpr double kGravity = 9.80665;  // m/s^2, standard
constexpr std::size_t kSamples = 10;  // for the means: half a scan of an IMU at 200 Hz

// Maximum values at a standstill.
constexpr double kMaxStillDistance = 0.03;  // m
constexpr double kMaxStillSpeed = 0.05;     // m/s
// Of a scan's mean IMU readings minus those expected at rest: detects the first acceleration.
constexpr double kMaxStillRate = 0.005;  // rad/s
constexpr double kMaxStillForce = 0.05;  // m/s^2

State::Matrix initial_covariance(bool still) {
  State::Matrix covariance = State::Matrix::Zero();
  const auto set = [&](State::Block block, int size, double sigma) {
    covariance.diagonal().segment(block, size).setConstant(sigma * sigma);
  };
  set(State::kPosition, 3, 1e-4);  // the start is the origin
  set(State::kRotation, 3, 1e-4);
  set(State::kLidarRotation, 3, std::sqrt(1e-5));
  set(State::kLidarPosition, 3, std::sqrt(1e-5));
  set(State::kVelocity, 3, still ? 0.01 : 3.0);
  set(State::kGyroBias, 3, still ? 1e-3 : 0.05);
  set(State::kAccelBias, 3, 0.1);
  set(State::kGravity, 2, still ? 0.02 : 0.5);
  return covariance;
}

}  // namespace

std::optional<Initialization> start_from(const std::vector<ImuSample>& samples,
                                         const Pose& imu_from_lidar) {
  const estimation::ImuStatistics imu = estimation::statistics(samples);
  if (imu.count < kSamples || !(imu.mean_accel.norm() > 0.0)) return std::nullopt;
  Initialization start;
  start.accel_scale = estimation::accel_scale_of(imu, kGravity);
  start.still = estimation::is_at_rest(imu, kGravity, start.accel_scale);
  State& state = start.estimate.state;
  state.gravity = -kGravity * imu.mean_accel.normalized();
  if (start.still) {
    state.nav.bias.gyro = imu.mean_gyro;
    state.nav.bias.accel = estimation::accel_bias_along_gravity(imu, kGravity, start.accel_scale);
  }
  state.imu_from_lidar = imu_from_lidar;
  start.estimate.covariance = initial_covariance(start.still);
  return start;
}

estimation::ImuTrack track_before(const std::vector<estimation::ImuInterval>& intervals,
                                  const State& state, double accel_scale) {
  estimation::ImuTrack track;
  Pose pose = state.world_from_imu();
  Eigen::Vector3d velocity = state.nav.velocity;
  for (auto interval = intervals.rbegin(); interval != intervals.rend(); ++interval) {
    const double dt = interval->seconds();
    const Eigen::Vector3d rate = interval->gyro - state.nav.bias.gyro;
    const Eigen::Matrix3d middle = pose.linear() * so3::exp(-0.5 * dt * rate);
    const Eigen::Vector3d force = accel_scale * interval->accel - state.nav.bias.accel;
    const Eigen::Vector3d acceleration = middle * force + state.gravity;
    pose.linear() = pose.linear() * so3::exp(-dt * rate);
    pose.translation() -= velocity * dt - 0.5 * dt * dt * acceleration;
    velocity -= acceleration * dt;
    track.push_back({interval->begin, pose, velocity, acceleration, rate});
  }
  std::ranges::reverse(track);
  return track;
}

State carried_back(const State& last, const std::vector<estimation::ImuInterval>& intervals,
                   State first, double accel_scale) {
  if (intervals.empty()) return first;
  const estimation::ImuStep then = track_before(intervals, last, accel_scale).front();
  const Eigen::Matrix3d turn = first.rotation() * then.world_from_imu.linear().transpose();
  first.nav.velocity = turn * then.velocity;
  first.nav.bias = last.nav.bias;
  first.gravity = turn * last.gravity;
  return first;
}

bool StillDetector::observe(const estimation::ImuStatistics& imu,
                            const estimation::InertialState& predicted,
                            const Eigen::Vector3d& position, double accel_scale) {
  const Eigen::Vector3d at_rest =
      predicted.nav.bias.accel - predicted.rotation().transpose() * predicted.gravity;
  const bool is_still = estimation::is_at_rest(imu, kGravity, accel_scale) &&
                        (imu.mean_gyro - predicted.nav.bias.gyro).norm() < kMaxStillRate &&
                        (accel_scale * imu.mean_accel - at_rest).norm() < kMaxStillForce &&
                        predicted.nav.velocity.norm() < kMaxStillSpeed &&
                        (scans_ == 0 || (position - anchor_).norm() < kMaxStillDistance);
  if (is_still && scans_ == 0) anchor_ = position;
  scans_ = is_still ? scans_ + 1 : 0;
  return is_still;
}

}  // namespace lidarena::odometry::arena_lio
