// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/estimation/plane_fit.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace lidarena::estimation {
namespace {

/// Five points on the plane with this normal at `distance` (m) from the origin.
FivePoints on_plane(const Eigen::Vector3d& normal, double distance) {
  const Eigen::Vector3d u = normal.unitOrthogonal();
  const Eigen::Vector3d v = normal.cross(u);
  FivePoints points;
  points << 0.3 * u, -0.2 * u + 0.1 * v, 0.1 * u - 0.4 * v, 0.2 * v, -0.1 * u - 0.3 * v;
  return points.colwise() + distance * normal;
}

TEST(PlaneFit, FindsThePlaneOfExactPoints) {
  const Eigen::Vector3d normal = Eigen::Vector3d(1, -2, 2) / 3.0;
  for (const double distance : {0.5, 3.0, 20.0}) {
    const auto plane = fit_plane(on_plane(normal, distance), 0.1);
    ASSERT_TRUE(plane) << distance;
    // single precision, with a patch of 0.5 m seen from `distance`
    EXPECT_LT(plane->normal.cross(normal).norm(), 1e-6 * (1.0 + distance)) << distance;
    EXPECT_NEAR(std::abs(plane->offset), distance, 1e-5 * distance);
    EXPECT_LT(plane->normal.dot(distance * normal) * plane->offset, 0.0) << "n . x + offset = 0";
  }
}

TEST(PlaneFit, RefusesPointsThatAreNotFlat) {
  FivePoints points = on_plane(Eigen::Vector3d::UnitZ(), 2.0);
  points(2, 2) += 0.3;
  EXPECT_FALSE(fit_plane(points, 0.05));
  EXPECT_TRUE(fit_plane(points, 0.3));
}

TEST(PlaneFit, HasNoPlaneThroughTheOrigin) {
  EXPECT_FALSE(fit_plane(on_plane(Eigen::Vector3d::UnitX(), 0.0), 0.01));
}

}  // namespace
}  // namespace lidarena::estimation
