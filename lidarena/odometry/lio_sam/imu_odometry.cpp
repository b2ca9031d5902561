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
constexpr double kDelayedScans = 3.0;        // duration of a scan and of the two it waits for

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

ImuOdometry::ImuOdometry(const Config& config, const Pose& imu_from_lidar, double scan_period)
    : imu_from_lidar_(imu_from_lidar),
      imu_{{config.gyro_noise_density, config.accel_noise_density, config.gyro_bias_walk,
            config.accel_bias_walk},
           1.0,
           {0.0, 0.0, -config.gravity}},
      samples_(kLongGap),
      delay_(from_seconds(kDelayedScans * scan_period)) {}

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
  for (; !underway_.empty() && underway_.front().stamp + delay_ < stamp; underway_.pop_front())
    use(underway_.front());
  stamp_ = stamp;
  longest_gap_s_ = 0.0;
  const Time needed = underway_.empty() ? stamp : underway_.front().stamp;
  samples_.remove_before(corrections_ > 0 ? smoothed_until_ : std::min(needed, stamp));
  if (corrections_ == 0) return;
  const std::vector<estimation::ImuInterval> since = samples_.between(smoothed_until_, stamp);
  longest_gap_s_ = estimation::longest_gap_s(since);
  estimation::Preintegration sum(smoother_.latest().bias, imu_.noise);
  estimation::integrate(since, smoother_.latest(), imu_, sum);
  now_ = sum.predict(smoother_.latest(), imu_.gravity);
}

std::optional<Pose> ImuOdometry::odom_from_lidar() const {
  if (corrections_ < kSpeaking) return std::nullopt;
  return now_.world_from_imu * imu_from_lidar_;
}

Pose ImuOdometry::motion_since_sent() const {
  ImuOdometry ahead = *this;
  ahead.delay_ = Time{0};
  ahead.advance(stamp_);
  if (ahead.corrections_ < kSpeaking) return Pose::Identity();
  const Pose last_from_now =
      ahead.smoother_.latest().world_from_imu.inverse() * ahead.now_.world_from_imu;
  return imu_from_lidar_.inverse() * last_from_now * imu_from_lidar_;
}

estimation::ImuTrack ImuOdometry::track(Time end) {
  estimation::NavState from = now_;
  from.bias.gyro.setZero();
  const std::vector<estimation::ImuInterval> intervals = samples_.between(stamp_, end);
  longest_gap_s_ = std::max(longest_gap_s_, estimation::longest_gap_s(intervals));
  estimation::Preintegration sum(from.bias, imu_.noise);
  return estimation::integrate(intervals, from, imu_, sum);
}

void ImuOdometry::send(const Pose& odom_from_lidar, bool degenerate) {
  underway_.push_back({stamp_, odom_from_lidar * imu_from_lidar_.inverse(), degenerate});
}

void ImuOdometry::use(const Correction& correction) {
  if (corrections_ == 0) {
    start(correction.odom_from_imu);
  } else {
    estimation::Preintegration sum(smoother_.latest().bias, imu_.noise);
    estimation::integrate(samples_.between(smoothed_until_, correction.stamp), smoother_.latest(),
                          imu_, sum);
    smoother_.add(sum, {correction.odom_from_imu, information(correction.degenerate)});
  }
  smoothed_until_ = correction.stamp;
  ++corrections_;
  if (!has_failed()) return;
  corrections_ = 0;
  now_ = {correction.odom_from_imu, Eigen::Vector3d::Zero(), {}};
  ++resets_;
}

void ImuOdometry::start(const Pose& odom_from_imu) {
  estimation::InertialStart begin;
  begin.state.world_from_imu = odom_from_imu;
  begin.covariance = start_covariance();
  begin.gravity = imu_.gravity;
  smoother_.start(begin);
}

bool ImuOdometry::has_failed() const {
  // Not "greater than": a state that is not finite has failed too.
  const estimation::NavState& state = smoother_.latest();
  return !(state.velocity.norm() <= kMaxSpeed && state.bias.accel.norm() <= kMaxBias &&
           state.bias.gyro.norm() <= kMaxBias);
}

}  // namespace lidarena::odometry::lio_sam
