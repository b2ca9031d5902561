// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/odometry/arena_lio/filter.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <utility>

#include "lidarena/base/random.hpp"
#include "tests/estimation/random_vector.hpp"

namespace lidarena::odometry::arena_lio {
namespace {

constexpr double kScan_s = 0.1;

/// A filter after `scans` scans that turn by `turn_sigma` (rad, each axis), are wrong by `sigma`,
/// of which the prediction claims `stated`, by a gyro whose scale errs by `scale`.
Filter after_turns(double sigma, double stated, double scale, int scans, double turn_sigma = 0.15) {
  SequentialRandom random(5, 1);
  Filter filter;
  for (int i = 0; i < scans; ++i) {
    Correction correction;
    correction.seconds = kScan_s;
    Eigen::Vector3d& turned = correction.turn.turned;
    turned = estimation::random_vector(random, turn_sigma);
    correction.rotation = scale * turned - filter.gyro.correction() * turned +
                          estimation::random_vector(random, sigma);
    correction.rotation_variance = stated * stated;
    filter = informed(std::move(filter), correction);
  }
  return filter;
}

TEST(InformedFilter, TheNoiseOfTurnsHasNoPartThatTheCalibrationExplains) {
  // 1 % of 0.15 rad is 1.5 mrad a scan.
  const Filter filter = after_turns(2e-4, 2e-4, 0.01, 200);
  EXPECT_LT(filter.gyro_noise.density(), 3e-4 / std::sqrt(kScan_s));
  EXPECT_LT((filter.gyro.correction() - 0.01 * Eigen::Matrix3d::Identity()).norm(), 2e-3);
}

TEST(InformedFilter, SlowNoisyTurnsCalibrateLittle) {
  // 5 mrad of 20 mrad a scan: 50 scans know an element of the correction to 0.035, the prior to
  // 0.01.
  const Filter trusted = after_turns(5e-3, 0.0, 0.0, 50, 0.02);
  const Filter stated = after_turns(5e-3, 5e-3, 0.0, 50, 0.02);
  EXPECT_LT(stated.gyro.correction().norm(), 0.5 * trusted.gyro.correction().norm());
  EXPECT_LT(stated.gyro.correction().norm(), 0.03);  // of nine elements of 0.01
}

}  // namespace
}  // namespace lidarena::odometry::arena_lio
