// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/estimation/feature_residuals.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "lidarena/base/random.hpp"
#include "lidarena/base/so3.hpp"
#include "tests/estimation/random_vector.hpp"

namespace lidarena::estimation {
namespace {

using Eigen::Vector3d;

TEST(FeatureResiduals, JacobiansAreTheNumericOnes) {
  SequentialRandom random(1, 1);
  for (int trial = 0; trial < 50; ++trial) {
    const Pose pose = make_pose(so3::exp(random_vector(random, 1.0)), random_vector(random, 3.0));
    const Vector3d point = random_vector(random, 3.0);
    const Vector3d seen = pose * point;
    const Line line{seen + random_vector(random, 0.2), random_vector(random, 1.0).normalized()};
    const Vector3d normal = random_vector(random, 1.0).normalized();
    const Plane plane{normal, -normal.dot(seen) + 0.1 * random.normal()};
    const auto stepped = [&](Eigen::Index k, double h) {
      return moved(pose, h * PoseEquations::Vector::Unit(k));
    };
    const auto check = [&](const auto& residual_at) {
      const std::optional<FeatureResidual> here = residual_at(pose);
      if (!here) return;
      // the Jacobian takes the weight as constant, so distances without the weight are compared
      const auto unweighted = [](const FeatureResidual& r) {
        return r.distance / r.row.tail(3).norm();
      };
      const double weight = here->row.tail<3>().norm();
      for (Eigen::Index k = 0; k < 6; ++k) {
        const double slope = (unweighted(*residual_at(stepped(k, 1e-6))) -
                              unweighted(*residual_at(stepped(k, -1e-6)))) /
                             2e-6;
        EXPECT_NEAR(here->row[k] / weight, slope, 1e-6) << k;
      }
    };
    check([&](const Pose& p) { return edge_residual(point, line, p); });
    check([&](const Pose& p) { return surface_residual(point, plane, p); });
  }
}

FivePoints five(const std::array<Vector3d, 5>& points) {
  FivePoints columns;
  for (int i = 0; i < 5; ++i) columns.col(i) = points[static_cast<std::size_t>(i)];
  return columns;
}

TEST(FeatureResiduals, ALineIsFoundOnlyWhereThereIsOne) {
  const auto line =
      fit_line(five({Vector3d{0, 0, 0}, {1, 0.01, 0}, {2, 0, 0.01}, {3, 0, 0}, {4, 0, 0}}));
  ASSERT_TRUE(line.has_value());
  EXPECT_NEAR(std::abs(line->direction.x()), 1.0, 1e-4);
  EXPECT_FALSE(fit_line(five({Vector3d{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}, {0.5, 0.5, 0}})));
}

TEST(FeatureResiduals, FarMatchesDoNotCount) {
  const Line line{Vector3d::Zero(), Vector3d::UnitX()};
  EXPECT_TRUE(edge_residual({5, 0.5, 0}, line, Pose::Identity()).has_value());
  EXPECT_FALSE(edge_residual({5, 1.01, 0}, line, Pose::Identity()).has_value())
      << "a weight of 1 - 0.9 * 1.01";
  const Plane plane{Vector3d::UnitZ(), 0.0};
  EXPECT_TRUE(surface_residual({9, 0, 2}, plane, Pose::Identity()).has_value())
      << "1 - 0.9 * 2 / 3: farther points may be farther off";
  EXPECT_FALSE(surface_residual({0, 0, 2}, plane, Pose::Identity()).has_value());
}

TEST(FeatureResiduals, ADirectionWithoutInformationIsDegenerateAndNotObserved) {
  PoseEquations::Matrix hessian = PoseEquations::Matrix::Identity();
  hessian(3, 3) = 0.01;
  const Degenerate found = find_degenerate(hessian, 0.1);
  EXPECT_EQ(found.directions, 1);
  const PoseEquations::Vector step = found.observed * PoseEquations::Vector::Ones();
  EXPECT_NEAR(step[3], 0.0, 1e-12);
  EXPECT_NEAR(step[4], 1.0, 1e-12);
  EXPECT_EQ(find_degenerate(hessian, 0.001).directions, 0);
  EXPECT_TRUE(find_degenerate(hessian, 0.001).observed.isIdentity());
}

}  // namespace
}  // namespace lidarena::estimation
