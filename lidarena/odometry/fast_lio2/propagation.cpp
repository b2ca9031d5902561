// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/odometry/fast_lio2/propagation.hpp"

#include <algorithm>
#include <cmath>

#include "lidarena/base/time.hpp"

namespace lidarena::odometry::fast_lio2 {
namespace {

using State = estimation::InertialState;

/// The program's variances are those of a sample, whatever its duration: a variance times dt^2 is a
/// density of sqrt(variance dt) over dt.
estimation::ImuNoise noise_over(double seconds, const Config& config) {
  const auto density = [seconds](double variance) { return std::sqrt(variance * seconds); };
  return {density(config.gyro_variance), density(config.accel_variance),
          density(config.gyro_bias_variance), density(config.accel_bias_variance)};
}

/// One step with the rate and force of `input`; returns the motion over it. Its acceleration is
/// that at the step's end.
estimation::ImuStep advance(const ImuSample& input, double seconds, const Config& config,
                            estimation::StateEstimate& estimate) {
  State& state = estimate.state;
  estimation::ImuStep step;
  step.world_from_imu = state.world_from_imu();
  step.velocity = state.nav.velocity;
  step.rate = input.gyro - state.nav.bias.gyro;
  State::Matrix f = estimation::propagate(state, input.gyro, input.accel, seconds,
                                          estimation::Integration::kFirstOrder);
  // The paper has Exp(-rate dt) here; in the program an integer division makes it the identity.
  f.block<3, 3>(State::kRotation, State::kRotation).setIdentity();
  estimate.covariance = f * estimate.covariance * f.transpose() +
                        estimation::step_noise(noise_over(seconds, config), seconds);
  step.acceleration = state.rotation() * (input.accel - state.nav.bias.accel) + state.gravity;
  return step;
}

/// Constant velocity, and the rate of the last of the `samples`: for a scan without new ones.
ImuSample coasting(const std::vector<ImuSample>& samples, const State& state) {
  const estimation::ImuBias& bias = state.nav.bias;
  const Eigen::Vector3d gyro = samples.empty() ? bias.gyro : samples.back().gyro;
  return {Time{0}, gyro, bias.accel - state.rotation().transpose() * state.gravity};
}

}  // namespace

estimation::ImuTrack propagate_forward(const std::vector<ImuSample>& samples, const ScanSpan& scan,
                                       const Config& config, estimation::StateEstimate& estimate) {
  estimation::ImuTrack track;
  Time reached = scan.estimated;
  ImuSample input = coasting(samples, estimate.state);
  for (std::size_t i = 1; i < samples.size(); ++i) {
    const ImuSample& head = samples[i - 1];
    const ImuSample& tail = samples[i];
    if (tail.stamp <= reached) continue;
    input.gyro = 0.5 * (head.gyro + tail.gyro);
    input.accel = 0.5 * (head.accel + tail.accel);
    track.push_back(advance(input, to_seconds(tail.stamp - reached), config, estimate));
    track.back().begin = track.size() == 1 ? std::min(scan.begin, tail.stamp) : reached;
    reached = tail.stamp;
  }
  estimation::ImuStep rest = advance(input, to_seconds(scan.end - reached), config, estimate);
  rest.begin = scan.begin;
  if (track.empty()) track.push_back(rest);
  State& state = estimate.state;
  state.nav.world_from_imu = orthonormalized(state.nav.world_from_imu);
  state.imu_from_lidar = orthonormalized(state.imu_from_lidar);
  return track;
}

}  // namespace lidarena::odometry::fast_lio2
