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

}  // namespace
}  // namespace lidarena::odometry::arena_lio
