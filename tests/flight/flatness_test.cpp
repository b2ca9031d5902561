// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/flight/flatness.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "lidarena/base/so3.hpp"

namespace lidarena::flight {
namespace {

using Eigen::Vector3d;
using Eigen::Vector4d;

/// Flat outputs with all derivatives in closed form: each coordinate is a sine.
FlatOutputs lissajous(double t) {
  const Vector4d amplitude{2.0, 1.5, 0.6, 1.2};
  const Vector4d frequency{1.1, 1.7, 2.3, 0.9};
  const Vector4d phase{0.0, 0.5, 1.0, 1.5};
  FlatOutputs out;
  for (std::size_t n = 0; n < out.size(); ++n) {
    for (int i = 0; i < 4; ++i) {
      const double quarter = static_cast<double>(n) * std::acos(0.0);
      out[n][i] = amplitude[i] * std::pow(frequency[i], static_cast<double>(n)) *
                  std::sin(frequency[i] * t + phase[i] + quarter);
    }
  }
  return out;
}

TEST(Flatness, HoverIsLevelAndTurnedByTheYaw) {
  const Eigen::Matrix3d r = attitude_of(Vector3d::Zero(), 0.7);
  EXPECT_NEAR((r - so3::exp(0.7 * Vector3d::UnitZ())).norm(), 0.0, 1e-15);
}

TEST(Flatness, ForwardAccelerationPitchesTheNoseDown) {
  const Eigen::Matrix3d r = attitude_of({kGravity, 0.0, 0.0}, 0.0);
  const Eigen::Matrix3d expected = so3::exp(std::atan(1.0) * Vector3d::UnitY());
  EXPECT_NEAR((r - expected).norm(), 0.0, 1e-15);
}

TEST(Flatness, BodyRateAndAngularAccelerationAreTheAttitudesDerivatives) {
  const double h = 1e-4;
  for (double t = 0.0; t < 10.0; t += 0.0917) {
    const Motion before = motion_of(lissajous(t - h));
    const Motion now = motion_of(lissajous(t));
    const Motion after = motion_of(lissajous(t + h));
    const Eigen::Matrix3d turn =
        before.world_from_body.linear().transpose() * after.world_from_body.linear();
    // h^2 / 6 times third derivatives of the order of 100 rad/s^3, and rounding 1e-15 / h
    EXPECT_NEAR((so3::log(turn) / (2.0 * h) - now.angular_rate_body).norm(), 0.0, 3e-6);
    const Vector3d gained = after.angular_rate_body - before.angular_rate_body;
    EXPECT_NEAR((gained / (2.0 * h) - now.angular_acceleration_body).norm(), 0.0, 3e-5);
  }
}

}  // namespace
}  // namespace lidarena::flight
