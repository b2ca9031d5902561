// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/estimation/point_to_plane.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "lidarena/base/random.hpp"
#include "lidarena/base/so3.hpp"
#include "tests/estimation/random_vector.hpp"

namespace lidarena::estimation {
namespace {

TEST(PointToPlane, TheJacobianIsTheNumericOne) {
  SequentialRandom random(6, 1);
  for (int i = 0; i < 50; ++i) {
    InertialState state;
    state.position() = random_vector(random, 3.0);
    state.rotation() = so3::exp(random_vector(random, 1.0));
    state.imu_from_lidar.linear() = so3::exp(random_vector(random, 1.0));
    state.imu_from_lidar.translation() = random_vector(random, 0.2);
    const Eigen::Vector3d point = random_vector(random, 5.0);
    const Plane plane{random_vector(random, 1.0).normalized(), random.normal()};
    const PointResidual residual = point_residual(point, plane, state, true);
    EXPECT_NEAR(residual.distance,
                plane.normal.dot(state.world_from_lidar() * point) + plane.offset, 1e-12);
    for (Eigen::Index k = 0; k < kPointDof; ++k) {
      const InertialState::Vector step = 1e-6 * InertialState::Vector::Unit(k);
      const double slope = (point_residual(point, plane, plus(state, step), true).distance -
                            point_residual(point, plane, plus(state, -step), true).distance) /
                           2e-6;
      EXPECT_NEAR(residual.row[k], slope, 1e-8);
    }
    EXPECT_EQ(point_residual(point, plane, state, false).row.tail<6>().norm(), 0.0);
  }
}

TEST(PointToPlane, InliersAreWithinAGateThatWidensWithTheRange) {
  EXPECT_TRUE(is_inlier(0.11, 1.0));
  EXPECT_FALSE(is_inlier(-0.112, 1.0));
  EXPECT_TRUE(is_inlier(-0.35, 10.0));
  EXPECT_FALSE(is_inlier(0.36, 10.0));
  EXPECT_FALSE(is_inlier(std::numeric_limits<double>::quiet_NaN(), 1.0));
}

TEST(PointToPlane, SumsAreThoseOfThePointsOnTheirPlanesAndTheOthersLoseThem) {
  const std::vector<Eigen::Vector3f> points{{0, 0, 1}, {1, 0, 1}, {0, 1, 1}};
  const Plane floor{Eigen::Vector3d::UnitZ(), -0.95};
  const Plane far{Eigen::Vector3d::UnitZ(), -0.5};
  PointPlanes planes{floor, std::nullopt, far};
  const auto sum = sum_residuals(points, {}, false, planes, Parallel(1));
  EXPECT_EQ(sum.count, 1U);
  EXPECT_NEAR(sum.hessian(2, 2), 1.0, 1e-12);
  EXPECT_NEAR(sum.gradient[2], 0.05, 1e-7);
  EXPECT_TRUE(planes[0].has_value());
  EXPECT_FALSE(planes[2].has_value()) << "0.5 m off at 1.4 m";
}

}  // namespace
}  // namespace lidarena::estimation
