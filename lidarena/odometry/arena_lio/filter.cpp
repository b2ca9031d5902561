// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/odometry/arena_lio/filter.hpp"

#include <utility>

#include "lidarena/base/so3.hpp"

namespace lidarena::odometry::arena_lio {
namespace {

using State = estimation::InertialState;

constexpr double kStillSpeedSigma = 0.01;        // m/s, of the zero velocity at a standstill
constexpr double kStillTranslationSigma = 1e-4;  // m, of the held first pose
constexpr double kStillRotationSigma = 1e-5;     // rad, of the held first pose
// rad, of corrections as observations of the gyro's calibration. The first ones are also those of a
// map of few scans and of biases that are not known yet.
constexpr double kCorrectionSigma = 1e-3;
constexpr double kFirstCorrectionSigma = 3e-3;
constexpr double kSettling_s = 2.0;  // of motion

/// The rotation over the intervals, from the rotation `map_from_begin` to that of `state`.
ScanTurn turn_over(const std::vector<estimation::ImuInterval>& intervals,
                   const Eigen::Matrix3d& map_from_begin, const State& state,
                   const ScanTurn& before) {
  ScanTurn turn;
  turn.turned = so3::log(map_from_begin.transpose() * state.rotation());
  const Eigen::Vector3d mean_rate =
      state.rotation() * turn.turned / to_seconds(intervals.back().end - intervals.front().begin);
  turn.rate_change =
      state.rotation().transpose() * (mean_rate - before.mean_rate.value_or(mean_rate));
  turn.mean_rate = mean_rate;
  return turn;
}

/// The values of the given axes, else zero.
Eigen::Vector3d on(const estimation::Axes& axes, const Eigen::Vector3d& values) {
  return axes.select(values.array(), 0.0);
}

/// What is added to a step's noise: an axis at the end of its range tells as little as a gap.
State::Matrix clipped_noise(const estimation::ImuInterval& interval,
                            const Eigen::Matrix3d& rotation) {
  constexpr estimation::ImuNoise kUnknown = estimation::kCoastingNoise;
  const auto variances = [&](const estimation::Axes& axes, double density) {
    return on(axes, Eigen::Vector3d::Constant(density * density * interval.seconds()));
  };
  State::Matrix noise = State::Matrix::Zero();
  noise.block<3, 3>(State::kRotation, State::kRotation) =
      variances(interval.gyro_clipped, kUnknown.gyro_density).asDiagonal();
  noise.block<3, 3>(State::kVelocity, State::kVelocity) =
      rotation * variances(interval.accel_clipped, kUnknown.accel_density).asDiagonal() *
      rotation.transpose();
  return noise;
}

}  // namespace

Filter initial_filter(const Initialization& found, const Eigen::Matrix3d& map_from_start) {
  Filter filter;
  filter.estimate = found.estimate;
  filter.accel_scale = found.accel_scale;
  State& state = filter.estimate.state;
  state.rotation() = map_from_start * state.rotation();
  state.gravity = map_from_start * state.gravity;
  filter.first_pose = state.world_from_imu();
  return filter;
}

Filter begun(Filter filter) {
  filter.track.clear();
  filter.steps.clear();
  return filter;
}

Filter predicted(Filter filter, const std::vector<estimation::ImuInterval>& intervals,
                 const estimation::ImuNoise& noise) {
  State& state = filter.estimate.state;
  State::Matrix& covariance = filter.estimate.covariance;
  const Eigen::Matrix3d map_from_begin = state.rotation();
  for (const estimation::ImuInterval& interval : intervals) {
    constexpr auto kIntegration = estimation::Integration::kSecondOrder;
    const double dt = interval.seconds();
    const estimation::ImuBias bias = state.nav.bias;
    const Eigen::Vector3d rate = filter.gyro.calibrated(interval.gyro - bias.gyro) +
                                 on(interval.gyro_clipped, filter.beyond_range);
    const Eigen::Vector3d gyro = rate + bias.gyro;
    const Eigen::Matrix3d rotation = estimation::rotation_in_step(state, gyro, dt, kIntegration);
    Eigen::Vector3d force = filter.accel_scale * interval.accel - bias.accel;
    if (interval.gap) force = -rotation.transpose() * state.gravity;  // constant velocity
    filter.track.push_back({interval.begin, state.world_from_imu(), state.nav.velocity,
                            rotation * force + state.gravity, rate});
    estimation::FilterStep step{filter.estimate, {}};
    const State::Matrix& f = step.transition =
        estimation::propagate(state, gyro, force + bias.accel, dt, kIntegration);
    covariance = f * covariance * f.transpose() +
                 estimation::step_noise(interval.gap ? estimation::kCoastingNoise : noise, dt) +
                 clipped_noise(interval, rotation);
    step.predicted = filter.estimate;
    filter.steps.push_back(std::move(step));
  }
  state.nav.world_from_imu = orthonormalized(state.nav.world_from_imu);
  state.imu_from_lidar = orthonormalized(state.imu_from_lidar);
  if (!intervals.empty()) filter.turn = turn_over(intervals, map_from_begin, state, filter.turn);
  return filter;
}

Filter informed(Filter filter, const Correction& correction) {
  filter.moved_s += correction.seconds;
  const double sigma = filter.moved_s < kSettling_s ? kFirstCorrectionSigma : kCorrectionSigma;
  const Eigen::Vector3d unexplained = filter.gyro.observe(
      correction.turn.turned, correction.turn.rate_change, correction.rotation, sigma);
  filter.gyro_noise.add(unexplained, correction.seconds);
  filter.accel_noise.add(correction.velocity, correction.seconds);
  return filter;
}

Filter beyond_range(Filter filter, const std::vector<estimation::ImuInterval>& intervals,
                    const Correction& correction) {
  Eigen::Vector3d direction = Eigen::Vector3d::Zero();  // of the turn, on the clipped axes
  for (const estimation::ImuInterval& interval : intervals)
    direction += on(interval.gyro_clipped, interval.gyro);
  const Eigen::Array3d sign = direction.array().sign();
  const Eigen::Vector3d rate = filter.beyond_range + correction.rotation / correction.seconds;
  filter.beyond_range = sign * (sign * rate.array()).max(0.0);
  return filter;
}

Filter tracked_back(Filter filter, const std::vector<estimation::ImuInterval>& intervals) {
  filter.track = track_before(intervals, filter.estimate.state, filter.accel_scale);
  return filter;
}

Filter bent(Filter filter, Time end) {
  filter.track =
      estimation::bent_track(std::move(filter.track), end, filter.estimate.state.world_from_imu());
  return filter;
}

Filter smoothed(Filter filter) {
  const std::vector<State> states = estimation::smoothed(filter.steps, filter.estimate.state);
  for (std::size_t i = 0; i < states.size(); ++i) {
    filter.track[i].world_from_imu = states[i].world_from_imu();
    filter.track[i].velocity = states[i].nav.velocity;
  }
  return filter;
}

Filter held_at_rest(Filter filter, const estimation::StateEstimate& estimate,
                    const std::vector<ImuSample>& samples) {
  const bool still = filter.still.observe(estimation::statistics(samples), filter.estimate.state,
                                          estimate.state.position(), filter.accel_scale);
  filter.estimate = estimate;
  filter.has_moved = filter.has_moved || !still;
  if (still) filter.estimate = estimation::zero_velocity_update(filter.estimate, kStillSpeedSigma);
  if (!filter.has_moved) {
    filter.estimate = estimation::pose_update(filter.estimate, filter.first_pose,
                                              kStillTranslationSigma, kStillRotationSigma);
  }
  return filter;
}

std::vector<Eigen::Vector3f> deskewed(const Scan& usable, const Filter& filter,
                                      const Parallel& parallel) {
  const State& state = filter.estimate.state;
  return estimation::deskew(usable, filter.track, state.imu_from_lidar, state.world_from_imu(),
                            parallel);
}

}  // namespace lidarena::odometry::arena_lio
