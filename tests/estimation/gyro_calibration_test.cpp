// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/estimation/gyro_calibration.hpp"

#include <gtest/gtest.h>

#include "lidarena/base/random.hpp"
#include "lidarena/base/so3.hpp"
#include "tests/estimation/random_vector.hpp"

namespace lidarena::estimation {
namespace {

constexpr double kSigma = 1e-3;  // rad, of the observed rotations

/// Scans of 0.1 s at constant rates of up to some rad/s, of which a gyro sees M times the truth.
GyroCalibration calibrated_with(const Eigen::Matrix3d& m, double rotation_sigma, int scans) {
  SequentialRandom random(3, 1);
  GyroCalibration calibration;
  for (int i = 0; i < scans; ++i) {
    const Eigen::Vector3d truth = random_vector(random, 1.5);  // rad/s
    const Eigen::Vector3d turned = 0.1 * calibration.calibrated(m * truth);
    const Eigen::Matrix3d estimated =
        so3::exp(0.1 * truth) * so3::exp(random_vector(random, rotation_sigma));
    calibration.observe(turned, Eigen::Vector3d::Zero(),
                        so3::log(so3::exp(turned).transpose() * estimated), kSigma);
  }
  return calibration;
}

TEST(GyroCalibration, FindsScaleFactorsAndMisalignments) {
  Eigen::Matrix3d m;
  m << 1.010, 0.004, -0.006, -0.003, 0.993, 0.005, 0.007, -0.002, 1.005;
  const GyroCalibration calibration = calibrated_with(m, 3e-4, 600);
  const Eigen::Matrix3d rest =
      (Eigen::Matrix3d::Identity() + calibration.correction()) * m - Eigen::Matrix3d::Identity();
  // 0.3 mrad of 0.15 rad in 600 scans: 8e-5; five sigmas
  EXPECT_LT(rest.cwiseAbs().maxCoeff(), 4e-4);
}

TEST(GyroCalibration, ChangesNothingWithoutTurns) {
  GyroCalibration calibration;
  for (int i = 0; i < 100; ++i)
    calibration.observe({1e-6, 0.0, 0.0}, {1e-6, 0.0, 0.0}, {1e-3, 1e-3, -1e-3}, kSigma);
  EXPECT_LT(calibration.correction().norm(), 1e-4);
  EXPECT_EQ(GyroCalibration().calibrated({1.0, 2.0, 3.0}), Eigen::Vector3d(1.0, 2.0, 3.0));
}

TEST(GyroCalibration, FindsTheDelayOfTheClock) {
  SequentialRandom random(3, 1);
  GyroCalibration calibration;
  constexpr double kDelay = 0.02;  // s
  for (int i = 0; i < 200; ++i) {
    const Eigen::Vector3d turned = random_vector(random, 0.1);
    const Eigen::Vector3d change = random_vector(random, 1.0);
    const Eigen::Vector3d missed = (kDelay - calibration.delay_s()) * change -
                                   calibration.correction() * turned;  // the truth has no such
    calibration.observe(turned, change, missed + random_vector(random, 3e-4), kSigma);
  }
  EXPECT_NEAR(calibration.delay_s(), kDelay, 2e-4);
  EXPECT_LT(calibration.correction().cwiseAbs().maxCoeff(), 2e-3);
}

}  // namespace
}  // namespace lidarena::estimation
