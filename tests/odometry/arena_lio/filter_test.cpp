// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/odometry/arena_lio/filter.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <utility>
#include <vector>

#include "lidarena/base/random.hpp"
#include "lidarena/base/so3.hpp"
#include "tests/estimation/random_vector.hpp"

namespace lidarena::odometry::arena_lio {
namespace {

constexpr double kScan_s = 0.1;

/// A filter after `scans` scans of lively turns that are wrong by `sigma` (rad, each axis), by a
/// gyro whose scale errs by `scale`.
Filter after_turns(double sigma, double scale, int scans) {
  SequentialRandom random(5, 1);
  Filter filter;
  for (int i = 0; i < scans; ++i) {
    Correction correction;
    correction.seconds = kScan_s;
    const Eigen::Vector3d turned = estimation::random_vector(random, 0.15);
    correction.turn.turned = turned;
    correction.rotation = scale * turned - filter.gyro.correction() * turned +
                          estimation::random_vector(random, sigma);
    filter = informed(std::move(filter), correction);
  }
  return filter;
}

TEST(InformedFilter, TheNoiseOfTurnsHasNoPartThatTheCalibrationExplains) {
  // 1 % of 0.15 rad is 1.5 mrad a scan.
  const Filter filter = after_turns(2e-4, 0.01, 200);
  EXPECT_LT(filter.gyro_noise.density(), 3e-4 / std::sqrt(kScan_s));
  EXPECT_LT((filter.gyro.correction() - 0.01 * Eigen::Matrix3d::Identity()).norm(), 2e-3);
}

TEST(InformedFilter, TheNoiseOfTurnsIsThatOfTheCorrections) {
  // A mean over 2 s, 60 draws, scatters by a fifth; the calibration takes a little of it.
  const Filter filter = after_turns(5e-3, 0.0, 400);
  EXPECT_NEAR(filter.gyro_noise.density(), 5e-3 / std::sqrt(kScan_s),
              0.3 * 5e-3 / std::sqrt(kScan_s));
}

/// 10 ms at 3 rad/s about y, where the gyro's range ends, and with 20 m/s^2 along z.
estimation::ImuInterval clipped(bool gyro, bool accel) {
  estimation::ImuInterval interval{.begin = Time{0}, .end = from_seconds(0.01)};
  interval.gyro = {0.1, 3.0, 0.0};
  interval.accel = {0.0, 0.0, 20.0};
  interval.gyro_clipped.y() = gyro;
  interval.accel_clipped.z() = accel;
  return interval;
}

TEST(ClippedFilter, OnlyTheClippedAxisIsAsUncertainAsInAGap) {
  using State = estimation::InertialState;
  Filter filter;
  filter.estimate.state.rotation() = so3::exp(Eigen::Vector3d(1.0, 0.0, 0.0));
  const auto after = [&](bool gyro, bool accel) {
    return predicted(filter, {clipped(gyro, accel)}, estimation::ImuNoise{}).estimate;
  };
  const State::Matrix added = after(true, true).covariance - after(false, false).covariance;
  const double gyro = estimation::kCoastingNoise.gyro_density;
  const double accel = estimation::kCoastingNoise.accel_density;
  const Eigen::Matrix3d turn = added.block<3, 3>(State::kRotation, State::kRotation);
  EXPECT_LT((turn - Eigen::Vector3d(0, gyro * gyro * 0.01, 0).asDiagonal().toDenseMatrix()).norm(),
            1e-12);
  // Half the turn of the step: where `rotation_in_step` is taken.
  const Eigen::Vector3d z = after(false, false).state.rotation() *
                            so3::exp(-0.5 * 0.01 * Eigen::Vector3d(0.1, 3.0, 0.0)) *
                            Eigen::Vector3d::UnitZ();
  const Eigen::Matrix3d velocity = added.block<3, 3>(State::kVelocity, State::kVelocity);
  EXPECT_LT((velocity - accel * accel * 0.01 * z * z.transpose()).norm(), 1e-9);
}

TEST(ClippedFilter, TheNextStepTurnsAsFarBeyondTheRangeAsTheLastCorrectionShowed) {
  const Correction correction{.turn = {}, .rotation = {0.01, 0.012, 0.0}, .seconds = 0.01};
  const std::vector<estimation::ImuInterval> slice{clipped(true, false)};
  Filter filter;
  filter = beyond_range(std::move(filter), slice, correction);
  EXPECT_TRUE(filter.beyond_range.isApprox(Eigen::Vector3d(0.0, 1.2, 0.0)))
      << "an axis within its range has no such rate";
  const Eigen::Vector3d turned =
      so3::log(predicted(filter, slice, estimation::ImuNoise{}).estimate.state.rotation());
  EXPECT_TRUE(turned.isApprox(Eigen::Vector3d(0.001, 0.042, 0.0)));
  filter = beyond_range(std::move(filter), slice, correction);
  EXPECT_DOUBLE_EQ(filter.beyond_range.y(), 2.4) << "corrections add up";
  filter = beyond_range(std::move(filter), slice, {{}, {0.0, -0.1, 0.0}, {}, 0.01});
  EXPECT_EQ(filter.beyond_range.y(), 0.0) << "no body turns less than its clipped gyro";
  filter.beyond_range.y() = 1.0;
  filter = beyond_range(std::move(filter), {clipped(false, false)}, correction);
  EXPECT_EQ(filter.beyond_range.norm(), 0.0) << "the gyro is within its range again";
}

}  // namespace
}  // namespace lidarena::odometry::arena_lio
