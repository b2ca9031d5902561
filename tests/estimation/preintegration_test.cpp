// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/estimation/preintegration.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>
#include <functional>

#include "lidarena/base/random.hpp"
#include "lidarena/base/so3.hpp"
#include "tests/estimation/random_vector.hpp"

namespace lidarena::estimation {
namespace {

using Eigen::Vector3d;

const Vector3d kTiltedGravity(0.3, -0.2, -9.8);  // any direction
constexpr ImuNoise kImuNoise{1e-3, 1e-2, 1e-4, 1e-3};

NavState some_state(SequentialRandom& random) {
  NavState state;
  state.world_from_imu = make_pose(so3::exp(random_vector(random, 1.0)), random_vector(random, 3));
  state.velocity = random_vector(random, 2.0);
  state.bias = {random_vector(random, 0.02), random_vector(random, 0.1)};
  return state;
}

/// True rate and specific force at `t` of an IMU that tumbles and accelerates.
Vector3d rate_at(double t) {
  return {0.9 * std::sin(3.0 * t), -0.6 + 0.5 * std::cos(2.0 * t), 1.1 * std::cos(4.0 * t)};
}
Vector3d force_at(double t) {
  return {2.0 * std::sin(5.0 * t), 1.0 + t, 9.8 + 3.0 * std::cos(3.0 * t)};
}

/// The motion over `seconds` in `steps` steps, each with the rate and force at its middle.
Preintegration summed(const ImuBias& true_bias, const ImuBias& assumed, double seconds, int steps) {
  Preintegration sum(assumed, kImuNoise);
  const double dt = seconds / steps;
  for (int i = 0; i < steps; ++i) {
    const double t = (i + 0.5) * dt;
    sum.integrate(rate_at(t) + true_bias.gyro, force_at(t) + true_bias.accel, dt);
  }
  return sum;
}

/// The same by Runge-Kutta on rotation matrix, velocity and position: an independent, accurate
/// reference.
NavState integrated(const NavState& first, double seconds) {
  struct Rates {
    Eigen::Matrix3d rotation;
    Vector3d velocity, position;
  };
  Eigen::Matrix3d r = first.world_from_imu.linear();
  Vector3d v = first.velocity;
  Vector3d p = first.world_from_imu.translation();
  constexpr int kSteps = 2000;
  const double h = seconds / kSteps;
  const auto rates = [](const Eigen::Matrix3d& rotation, const Vector3d& velocity, double t) {
    return Rates{rotation * so3::hat(rate_at(t)), rotation * force_at(t) + kTiltedGravity,
                 velocity};
  };
  for (int i = 0; i < kSteps; ++i) {
    const double t = i * h;
    const Rates a = rates(r, v, t);
    const Rates b = rates(r + 0.5 * h * a.rotation, v + 0.5 * h * a.velocity, t + 0.5 * h);
    const Rates c = rates(r + 0.5 * h * b.rotation, v + 0.5 * h * b.velocity, t + 0.5 * h);
    const Rates d = rates(r + h * c.rotation, v + h * c.velocity, t + h);
    r += h / 6.0 * (a.rotation + 2.0 * b.rotation + 2.0 * c.rotation + d.rotation);
    v += h / 6.0 * (a.velocity + 2.0 * b.velocity + 2.0 * c.velocity + d.velocity);
    p += h / 6.0 * (a.position + 2.0 * b.position + 2.0 * c.position + d.position);
  }
  NavState last = first;
  last.world_from_imu = make_pose(r, p);
  last.velocity = v;
  return last;
}

TEST(Preintegration, PredictsWhatRungeKuttaFindsToSecondOrder) {
  SequentialRandom random(1, 1);
  const NavState first = some_state(random);
  const NavState last = integrated(first, 0.5);
  double before = 0.0;
  for (const int steps : {50, 100, 200}) {
    const NavState found =
        summed(first.bias, first.bias, 0.5, steps).predict(first, kTiltedGravity);
    const double error = minus(found, last).norm();
    if (before > 0.0) {
      EXPECT_NEAR(before / error, 4.0, 0.2) << "half the step, a quarter of the error";
    }
    before = error;
  }
  // second order: h^2 / 24 of the second derivative of the force in the world, which is below
  // 9 * (13 m/s^2); over 0.5 s with h = 2.5 ms
  EXPECT_LT(before, 0.5 * 0.0025 * 0.0025 / 24.0 * 9.0 * 13.0 * 4.0);
}

TEST(Preintegration, IsExactForConstantTurningWithoutForceAndForForceWithoutTurning) {
  Preintegration turning({}, kImuNoise);
  Preintegration pushed({}, kImuNoise);
  for (int i = 0; i < 20; ++i) {
    turning.integrate({0.1, 0.2, 0.9}, Vector3d::Zero(), 0.01);
    pushed.integrate(Vector3d::Zero(), {1.0, 2.0, 3.0}, 0.01);
  }
  EXPECT_LT((turning.motion({}).rotation - so3::exp({0.02, 0.04, 0.18})).norm(), 1e-14);
  EXPECT_LT((pushed.motion({}).velocity - Vector3d(0.2, 0.4, 0.6)).norm(), 1e-14);
  EXPECT_LT((pushed.motion({}).position - Vector3d(0.02, 0.04, 0.06)).norm(), 1e-14);
  EXPECT_DOUBLE_EQ(pushed.seconds(), 0.2);
}

TEST(Preintegration, AChangeOfBiasIsFollowedToFirstOrder) {
  SequentialRandom random(2, 1);
  const ImuBias truth{random_vector(random, 0.02), random_vector(random, 0.1)};
  for (const double size : {1e-3, 1e-4}) {
    const ImuBias other{truth.gyro + random_vector(random, size),
                        truth.accel + random_vector(random, size)};
    const RelativeMotion exact = summed(truth, truth, 0.3, 60).motion(truth);
    const RelativeMotion corrected = summed(truth, other, 0.3, 60).motion(truth);
    const RelativeMotion uncorrected = summed(truth, other, 0.3, 60).motion(other);
    EXPECT_GT((uncorrected.velocity - exact.velocity).norm(), 0.05 * size);
    // what is left is of second order: the change's square times time and force
    EXPECT_LT((corrected.velocity - exact.velocity).norm(), 20.0 * size * size);
    EXPECT_LT((corrected.position - exact.position).norm(), 20.0 * size * size);
    EXPECT_LT(so3::angle(corrected.rotation.transpose() * exact.rotation), 20.0 * size * size);
  }
}

TEST(Preintegration, TheResidualIsZeroWhereItPredicts) {
  SequentialRandom random(3, 1);
  const NavState first = some_state(random);
  const Preintegration sum = summed(first.bias, {}, 0.2, 40);
  EXPECT_LT(sum.residual(first, sum.predict(first, kTiltedGravity), kTiltedGravity).value.norm(),
            1e-13);
}

TEST(Preintegration, TheJacobiansAreTheNumericOnes) {
  SequentialRandom random(4, 1);
  for (int trial = 0; trial < 10; ++trial) {
    const NavState first = some_state(random);
    const Preintegration sum = summed(first.bias, {}, 0.2, 40);
    NavState::Vector off;
    for (double& x : off) x = 0.1 * random.normal();
    const NavState second = plus(sum.predict(first, kTiltedGravity), off);
    const InertialResidual r = sum.residual(first, second, kTiltedGravity);
    const auto slope = [](const std::function<NavState::Vector(double)>& f) {
      return NavState::Vector((f(1e-6) - f(-1e-6)) / 2e-6);
    };
    for (Eigen::Index k = 0; k < NavState::kDof; ++k) {
      const NavState::Vector unit = NavState::Vector::Unit(k);
      const auto by_first = slope([&](double h) {
        return sum.residual(plus(first, h * unit), second, kTiltedGravity).value;
      });
      const auto by_second = slope([&](double h) {
        return sum.residual(first, plus(second, h * unit), kTiltedGravity).value;
      });
      EXPECT_LT((r.by_first.col(k) - by_first).norm(), 1e-7) << k;
      EXPECT_LT((r.by_second.col(k) - by_second).norm(), 1e-7) << k;
    }
  }
}

TEST(Preintegration, TheCovarianceIsThatOfManyNoisyRuns) {
  constexpr int kRuns = 4000;
  constexpr int kSteps = 20;
  constexpr double kDt = 0.005;
  SequentialRandom random(5, 1);
  const NavState first{};
  const Preintegration clean = summed({}, {}, kSteps * kDt, kSteps);
  const NavState second = clean.predict(first, kTiltedGravity);
  Eigen::Matrix<double, 9, 9> spread = Eigen::Matrix<double, 9, 9>::Zero();
  for (int run = 0; run < kRuns; ++run) {
    Preintegration noisy({}, kImuNoise);
    for (int i = 0; i < kSteps; ++i) {
      const double t = (i + 0.5) * kDt;
      noisy.integrate(rate_at(t) + random_vector(random, kImuNoise.gyro_density / std::sqrt(kDt)),
                      force_at(t) + random_vector(random, kImuNoise.accel_density / std::sqrt(kDt)),
                      kDt);
    }
    const NavState::Vector all = noisy.residual(first, second, kTiltedGravity).value;
    const Eigen::Matrix<double, 9, 1> r = all.head<9>();
    spread += r * r.transpose() / kRuns;
  }
  // Whitened by the predicted covariance: the identity, +-1/sqrt(runs) in each entry, sqrt(2) times
  // that on the diagonal; five sigma.
  const Eigen::Matrix<double, 9, 9> predicted = clean.covariance().topLeftCorner<9, 9>();
  const Eigen::LLT<Eigen::Matrix<double, 9, 9>> root(predicted);
  const Eigen::Matrix<double, 9, 9> whitened =
      root.matrixL().solve(root.matrixL().solve(spread).transpose());
  const double five_sigma = 5.0 * std::sqrt(2.0 / kRuns);
  EXPECT_LT((whitened - Eigen::Matrix<double, 9, 9>::Identity()).cwiseAbs().maxCoeff(), five_sigma);
  EXPECT_NEAR(clean.covariance()(NavState::kGyroBias, NavState::kGyroBias),
              kImuNoise.gyro_bias_walk * kImuNoise.gyro_bias_walk * kSteps * kDt, 1e-18);
}

}  // namespace
}  // namespace lidarena::estimation
