// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <numbers>
#include <unsupported/Eigen/MatrixFunctions>

#include "lidarena/base/random.hpp"
#include "lidarena/base/se3.hpp"
#include "lidarena/base/so3.hpp"

namespace lidarena {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using se3::Matrix6;
using se3::Vector6;

// Rotation vectors where the formulas change branch or lose digits: 0, tiny, either side of the
// series' limits (1e-2 rad and 0.1 rad), ordinary, and next to pi.
std::vector<Vector3d> rotation_vectors() {
  SequentialRandom random(7);
  std::vector<Vector3d> vectors{Vector3d::Zero()};
  for (const double angle : {1e-12, 1e-8, 1e-5, 0.00999, 0.01001, 0.0999, 0.1001, 0.5, 1.0, 2.0,
                             3.0, std::numbers::pi - 1e-4, std::numbers::pi - 1e-8}) {
    const Vector3d axis(random.normal(), random.normal(), random.normal());
    vectors.push_back(angle * axis.normalized());
  }
  return vectors;
}

std::vector<Vector6> twists() {
  SequentialRandom random(8);
  std::vector<Vector6> twists;
  for (const Vector3d& phi : rotation_vectors()) {
    Vector6 xi;
    xi << random.uniform(-3, 3), random.uniform(-3, 3), random.uniform(-3, 3), phi;
    twists.push_back(xi);
  }
  return twists;
}

TEST(So3, ExponentialAgreesWithTheMatrixSeries) {
  for (const Vector3d& v : rotation_vectors()) {
    const Matrix3d expected = so3::hat(v).exp();
    EXPECT_LT((so3::exp(v) - expected).norm(), 1e-13) << v.transpose();
  }
}

TEST(So3, LogarithmUndoesTheExponentialUpToPi) {
  for (const Vector3d& v : rotation_vectors()) {
    EXPECT_LT((so3::log(so3::exp(v)) - v).norm(), 1e-10) << v.transpose();
    EXPECT_NEAR(so3::angle(so3::exp(v)), v.norm(), 1e-12);
  }
}

TEST(So3, LeftAndRightJacobiansAgreeWithCentralDifferences) {
  constexpr double h = 1e-6;  // error of the differences ~ h^2 + 1e-16 / h, about 1e-10
  for (const Vector3d& v : rotation_vectors()) {
    if (v.norm() > 3.0) continue;  // the logarithm jumps at pi
    Matrix3d left;
    Matrix3d right;
    for (int i = 0; i < 3; ++i) {
      const Vector3d d = h * Vector3d::Unit(i);
      const Matrix3d plus = so3::exp(v + d);
      const Matrix3d minus = so3::exp(v - d);
      left.col(i) = so3::log(plus * minus.transpose()) / (2 * h);
      right.col(i) = so3::log(minus.transpose() * plus) / (2 * h);
    }
    EXPECT_LT((so3::left_jacobian(v) - left).norm(), 1e-8) << v.transpose();
    EXPECT_LT((so3::right_jacobian(v) - right).norm(), 1e-8) << v.transpose();
    EXPECT_LT((so3::left_jacobian(v) * so3::left_jacobian_inverse(v) - Matrix3d::Identity()).norm(),
              1e-11);
    EXPECT_LT(
        (so3::right_jacobian(v) * so3::right_jacobian_inverse(v) - Matrix3d::Identity()).norm(),
        1e-11);
  }
}

TEST(Se3, ExponentialAgreesWithTheMatrixSeriesAndLogarithmUndoesIt) {
  for (const Vector6& xi : twists()) {
    Eigen::Matrix4d generator = Eigen::Matrix4d::Zero();
    generator.topLeftCorner<3, 3>() = so3::hat(xi.tail<3>());
    generator.topRightCorner<3, 1>() = xi.head<3>();
    EXPECT_LT((se3::exp(xi).matrix() - generator.exp()).norm(), 1e-12) << xi.transpose();
    EXPECT_LT((se3::log(se3::exp(xi)) - xi).norm(), 1e-7) << xi.transpose();
  }
}

TEST(Se3, LeftAndRightJacobiansAgreeWithCentralDifferences) {
  constexpr double h = 1e-6;
  for (const Vector6& xi : twists()) {
    if (xi.tail<3>().norm() > 3.0) continue;
    Matrix6 left;
    Matrix6 right;
    for (int i = 0; i < 6; ++i) {
      const Vector6 d = h * Vector6::Unit(i);
      const Pose plus = se3::exp(xi + d);
      const Pose minus = se3::exp(xi - d);
      left.col(i) = se3::log(plus * minus.inverse()) / (2 * h);
      right.col(i) = se3::log(minus.inverse() * plus) / (2 * h);
    }
    EXPECT_LT((se3::left_jacobian(xi) - left).norm(), 1e-7) << xi.transpose();
    EXPECT_LT((se3::right_jacobian(xi) - right).norm(), 1e-7) << xi.transpose();
    EXPECT_LT(
        (se3::left_jacobian(xi) * se3::left_jacobian_inverse(xi) - Matrix6::Identity()).norm(),
        1e-10);
  }
}

}  // namespace
}  // namespace lidarena
