// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/odometry/lio_sam/imu_odometry.hpp"

#include <algorithm>

#include "lidarena/estimation/imu_at_rest.hpp"

namespace lidarena::odometry::lio_sam {
namespace {

constexpr std::size_t kStartSamples = 10;    // minimum number of IMU samples at the start
constexpr Time kStartMemory{1'000'000'000};  // maximum age of these samples
constexpr double kLongGap = 0.05;            // s; over longer gaps the motion is coasted
constexpr double kMaxSpeed = 30.0;           // m/s; the program resets beyond this ...
constexpr double kMaxBias = 1.0;             // ... and this bias, m/s^2, rad/s
constexpr int kSpeaking = 2;                 // corrections from which on there are poses

/// Of a registered pose: sigmas of 0.05 rad and 0.1 m, when degenerate 1 rad and 1 m.
estimation::PoseMeasurement::Information information(bool degenerate) {
  Eigen::Matrix<double, 6, 1> sigma;
  sigma << Eigen::Vector3d::Constant(degenerate ? 1.0 : 0.05),
      Eigen::Vector3d::Constant(degenerate ? 1.0 : 0.1);
  return sigma.cwiseAbs2().cwiseInverse().asDiagonal();
}

/// At the start: nearly none for the biases, hardly anything known of the velocity.
estimation::NavState::Matrix start_covariance() {
  estimation::NavState::Vector sigma = estimation::NavState::Vector::Constant(1e-2);
  sigma.segment<3>(estimation::NavState::kVelocity).setConstant(1e4);
  sigma.segment<3>(estimation::NavState::kGyroBias).setConstant(1e-3);
  sigma.segment<3>(estimation::NavState::kAccelBias).setConstant(1e-3);
  return sigma.cwiseAbs2().asDiagonal();
}

}  // namespace

ImuOdometry::ImuOdometry(const Config& config, const Pose& imu_from_lidar)
    : imu_from_lidar_(imu_from_lidar),
      imu_{{config.gyro_noise_density, config.accel_noise_density, config.gyro_bias_walk,
            config.accel_bias_walk},
           1.0,
           {0.0, 0.0, -config.gravity}},
      samples_(kLongGap),
      pending_(estimation::ImuBias{}, imu_.noise) {}

bool ImuOdometry::is_ready(Time end) {
  if (ready_) return true;
  samples_.remove_before(end - kStartMemory);
  const std::vector<ImuSample> recent = samples_.samples(end - kStartMemory, end);
  ready_ = recent.size() >= kStartSamples;
  if (ready_)
    imu_.accel_scale =
        estimation::accel_scale_of(estimation::statistics(recent), -imu_.gravity.z());
  return ready_;
}

void ImuOdometry::advance(Time stamp) {
  longest_gap_s_ = 0.0;
  if (corrections_ > 0) {
    const std::vector<estimation::ImuInterval> intervals = samples_.between(stamp_, stamp);
    longest_gap_s_ = estimation::longest_gap_s(intervals);
    estimation::integrate(intervals, smoother_.latest(), imu_, pending_);
    now_ = pending_.predict(smoother_.latest(), imu_.gravity);
  }
  stamp_ = corrections_ > 0 ? std::max(stamp_, stamp) : stamp;
  samples_.remove_before(stamp);
}

std::optional<Pose> ImuOdometry::odom_from_lidar() const {
  if (corrections_ < kSpeaking) return std::nullopt;
  return now_.world_from_imu * imu_from_lidar_;
}

estimation::ImuTrack ImuOdometry::track(Time end) {
  estimation::NavState from = now_;
  from.bias.gyro.setZero();
  const std::vector<estimation::ImuInterval> intervals = samples_.between(stamp_, end);
  longest_gap_s_ = std::max(longest_gap_s_, estimation::longest_gap_s(intervals));
  estimation::Preintegration sum(from.bias, imu_.noise);
  return estimation::integrate(intervals, from, imu_, sum);
}

void ImuOdometry::correct(const Pose& odom_from_lidar, bool degenerate) {
  const Pose odom_from_imu = odom_from_lidar * imu_from_lidar_.inverse();
  if (corrections_ == 0) {
    restart(odom_from_imu);
  } else {
    smoother_.add(pending_, {odom_from_imu, information(degenerate)});
    now_ = smoother_.latest();
  }
  ++corrections_;
  pending_ = {now_.bias, imu_.noise};
  if (!has_failed()) return;
  corrections_ = 0;
  now_ = {odom_from_imu, Eigen::Vector3d::Zero(), {}};
  ++resets_;
}

void ImuOdometry::restart(const Pose& odom_from_imu) {
  now_ = {odom_from_imu, Eigen::Vector3d::Zero(), {}};
  estimation::InertialStart start;
  start.state = now_;
  start.covariance = start_covariance();
  start.gravity = imu_.gravity;
  smoother_.start(start);
}

bool ImuOdometry::has_failed() const {
  // Not "greater than": a state that is not finite has failed too.
  return !(now_.velocity.norm() <= kMaxSpeed && now_.bias.accel.norm() <= kMaxBias &&
           now_.bias.gyro.norm() <= kMaxBias);
}

}  // namespace lidarena::odometry::lio_sam
