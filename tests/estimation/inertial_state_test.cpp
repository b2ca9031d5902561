// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/estimation/inertial_state.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "lidarena/base/random.hpp"
#include "lidarena/base/so3.hpp"
#include "tests/estimation/random_vector.hpp"

namespace lidarena::estimation {
namespace {

InertialState random_state(SequentialRandom& random) {
  InertialState state;
  state.position() = random_vector(random, 5.0);
  state.rotation() = so3::exp(random_vector(random, 1.0));
  state.imu_from_lidar.linear() = so3::exp(random_vector(random, 1.0));
  state.imu_from_lidar.translation() = random_vector(random, 0.1);
  state.nav.velocity = random_vector(random, 2.0);
  state.nav.bias.gyro = random_vector(random, 0.01);
  state.nav.bias.accel = random_vector(random, 0.1);
  state.gravity = so3::exp(random_vector(random, 1.0)) * state.gravity;
  return state;
}

InertialState::Vector random_tangent(SequentialRandom& random, double sigma) {
  InertialState::Vector v;
  for (Eigen::Index i = 0; i < v.size(); ++i) v[i] = sigma * random.normal();
  return v;
}

/// Central differences of minus(f(e), f(0)) at e = 0.
InertialState::Matrix numeric_jacobian(
    const std::function<InertialState(const InertialState::Vector&)>& f) {
  constexpr double kStep = 1e-6;
  const InertialState at_zero = f(InertialState::Vector::Zero());
  InertialState::Matrix jacobian;
  for (Eigen::Index i = 0; i < InertialState::kDof; ++i) {
    const InertialState::Vector e = kStep * InertialState::Vector::Unit(i);
    jacobian.col(i) = (minus(f(e), at_zero) - minus(f(-e), at_zero)) / (2.0 * kStep);
  }
  return jacobian;
}

TEST(InertialState, MinusUndoesPlus) {
  SequentialRandom random(1, 1);
  for (int i = 0; i < 100; ++i) {
    const InertialState a = random_state(random);
    const InertialState::Vector delta = random_tangent(random, 0.5);
    EXPECT_LT((minus(plus(a, delta), a) - delta).norm(), 1e-9);
    EXPECT_NEAR(plus(a, delta).gravity.norm(), a.gravity.norm(), 1e-12);
    const InertialState b = random_state(random);
    EXPECT_LT(minus(plus(a, minus(b, a)), b).norm(), 1e-9);
  }
}

TEST(InertialState, GravityAcrossTheSphere) {
  InertialState up;
  up.gravity = -up.gravity;
  const InertialState down;
  EXPECT_NEAR(minus(up, down).norm(), M_PI, 1e-12) << "the opposite direction is half a turn away";
  EXPECT_LT((plus(down, minus(up, down)).gravity - up.gravity).norm(), 1e-9);
  EXPECT_EQ(minus(up, up).norm(), 0.0);
}

TEST(InertialState, TheTangentBasisIsOrthonormalAndAcross) {
  SequentialRandom random(2, 1);
  for (int i = 0; i < 100; ++i) {
    const Eigen::Vector3d direction = random_vector(random, 3.0);
    const Eigen::Matrix<double, 3, 2> basis = tangent_basis(direction);
    EXPECT_LT((basis.transpose() * basis - Eigen::Matrix2d::Identity()).norm(), 1e-12);
    EXPECT_LT((basis.transpose() * direction).norm(), 1e-12 * direction.norm());
  }
}

TEST(InertialState, TransportIsTheNumericJacobian) {
  SequentialRandom random(3, 1);
  for (int i = 0; i < 20; ++i) {
    const InertialState from = random_state(random);
    const InertialState::Vector delta = random_tangent(random, 0.4);
    const InertialState::Matrix numeric =
        numeric_jacobian([&](const InertialState::Vector& e) { return plus(from, delta + e); });
    EXPECT_LT((transport(from, delta) - numeric).cwiseAbs().maxCoeff(), 1e-7);
  }
}

TEST(InertialState, PropagationsJacobianIsTheNumericOne) {
  SequentialRandom random(4, 1);
  for (const Integration order : {Integration::kFirstOrder, Integration::kSecondOrder}) {
    for (int i = 0; i < 20; ++i) {
      const InertialState state = random_state(random);
      const Eigen::Vector3d gyro = random_vector(random, 2.0);
      const Eigen::Vector3d accel = random_vector(random, 10.0);
      constexpr double kSeconds = 0.05;
      const auto stepped = [&](const InertialState::Vector& e) {
        InertialState moved = plus(state, e);
        propagate(moved, gyro, accel, kSeconds, order);
        return moved;
      };
      InertialState moved = state;
      const InertialState::Matrix f = propagate(moved, gyro, accel, kSeconds, order);
      EXPECT_LT((f - numeric_jacobian(stepped)).cwiseAbs().maxCoeff(), 1e-7);
    }
  }
}

TEST(InertialState, FreeFallAndATurnInClosedForm) {
  InertialState state;
  state.nav.velocity = {1.0, 0.0, 2.0};
  state.nav.bias.gyro = {0.0, 0.0, 0.1};
  const double dt = 0.005;
  for (int i = 0; i < 200; ++i) {  // 1 s: free fall and a rotation, with a gyro bias
    propagate(state, {0.0, 0.0, 0.6}, Eigen::Vector3d::Zero(), dt, Integration::kSecondOrder);
  }
  const double g = 9.80665;
  EXPECT_LT((state.position() - Eigen::Vector3d(1.0, 0.0, 2.0 - 0.5 * g)).norm(), 1e-9);
  EXPECT_LT((state.nav.velocity - Eigen::Vector3d(1.0, 0.0, 2.0 - g)).norm(), 1e-9);
  EXPECT_LT((state.rotation() - so3::exp({0.0, 0.0, 0.5})).norm(), 1e-9);

  InertialState first_order;
  first_order.nav.velocity = {1.0, 0.0, 2.0};
  for (int i = 0; i < 200; ++i) {
    propagate(first_order, Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero(), dt,
              Integration::kFirstOrder);
  }
  // The sum of v dt with v at the beginning of each step differs from the integral by g T dt / 2.
  EXPECT_NEAR(first_order.position().z(), 2.0 - 0.5 * g + 0.5 * g * dt, 1e-9);
}

TEST(InertialState, AForceThatTurnsWithTheBodyIsIntegratedToSecondOrder) {
  // Turning at w with a force f along the body's x: the velocity is f/w (sin wt, 1 - cos wt).
  constexpr double kRate = 5.0;   // rad/s
  constexpr double kForce = 3.0;  // m/s^2
  constexpr double kStep = 0.005;
  const auto error_of = [&](Integration integration) {
    InertialState state;
    state.gravity.setZero();
    for (int i = 0; i < 100; ++i)
      propagate(state, {0.0, 0.0, kRate}, {kForce, 0.0, 0.0}, kStep, integration);
    const double turned = 100 * kStep * kRate;
    const Eigen::Vector3d exact =
        kForce / kRate * Eigen::Vector3d(std::sin(turned), 1.0 - std::cos(turned), 0.0);
    return (state.nav.velocity - exact).norm();
  };
  // A midpoint rule is off by (w dt)^2 / 24 of the change of 2 f/w sin(wt / 2), a rule of the
  // begin by w dt / 2.
  const double change = 2.0 * kForce / kRate * std::sin(0.5 * 100 * kStep * kRate);
  EXPECT_NEAR(error_of(Integration::kSecondOrder), std::pow(kRate * kStep, 2) / 24.0 * change,
              1e-6);
  EXPECT_NEAR(error_of(Integration::kFirstOrder), 0.5 * kRate * kStep * change, 1e-4);
}

TEST(InertialState, NoiseOfManyStepsIsThatOfTheirSum) {
  const ImuNoise noise{1e-3, 1e-2, 1e-5, 1e-4};
  InertialState::Matrix sum = InertialState::Matrix::Zero();
  for (int i = 0; i < 200; ++i) sum += step_noise(noise, 0.005);
  EXPECT_NEAR(sum(InertialState::kRotation, InertialState::kRotation), 1e-6,
              1e-15);  // density^2 * 1 s
  EXPECT_NEAR(sum(InertialState::kVelocity + 2, InertialState::kVelocity + 2), 1e-4, 1e-13);
  EXPECT_NEAR(sum(InertialState::kGyroBias, InertialState::kGyroBias), 1e-10, 1e-19);
  EXPECT_NEAR(sum(InertialState::kAccelBias, InertialState::kAccelBias), 1e-8, 1e-17);
  EXPECT_NEAR(sum.trace(), 3.0 * (1e-6 + 1e-4 + 1e-10 + 1e-8), 1e-12) << "all others are zero";
}

}  // namespace
}  // namespace lidarena::estimation
