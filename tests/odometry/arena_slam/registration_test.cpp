// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/odometry/arena_slam/registration.hpp"

#include <gtest/gtest.h>

#include "lidarena/base/so3.hpp"

namespace lidarena::odometry::arena_slam {
namespace {

/// Surface points of a room's walls; bit 0 of `open` leaves out those perpendicular to x, bit 1
/// those to y, bit 2 those to z.
std::vector<Eigen::Vector3f> walls(int open) {
  std::vector<Eigen::Vector3f> points;
  for (int axis = 0; axis < 3; ++axis) {
    if ((open >> axis & 1) != 0) continue;
    for (int i = -25; i <= 25; ++i) {
      for (int k = -25; k <= 25; ++k) {
        for (const float side : {-4.0F, 4.0F}) {
          Eigen::Vector3f p;
          p[axis] = side;
          p[(axis + 1) % 3] = 0.16F * static_cast<float>(i);
          p[(axis + 2) % 3] = 0.16F * static_cast<float>(k);
          points.push_back(p);
        }
      }
    }
  }
  return points;
}

/// Every seventh of the map's points, as seen from `pose`.
map::Features seen(const std::vector<Eigen::Vector3f>& points, const Pose& pose) {
  map::Features features;
  for (std::size_t i = 0; i < points.size(); i += 7)
    features.surfaces.push_back((pose.inverse() * points[i].cast<double>()).cast<float>());
  return features;
}

/// A map of one keyframe with these surface points (m, world).
map::FeatureMap map_of(const std::vector<Eigen::Vector3f>& points) {
  map::FeatureMap map({.edge_size_m = 0.1, .surface_size_m = 0.01});  // all points stay
  map.select({{Time{0}, Pose::Identity(), {{}, points}, 0}}, {0});
  return map;
}

TEST(ArenaSlamRegistration, FindsTheWayHome) {
  const std::vector<Eigen::Vector3f> points = walls(0);
  const map::FeatureMap map = map_of(points);
  const Pose truth = make_pose(so3::exp({0.1, -0.2, 0.5}), {0.3, 0.2, -0.4});
  const Pose guess = truth * make_pose(so3::exp({0.02, 0.03, -0.03}), {0.1, -0.08, 0.1});
  const Registration found = register_features(seen(points, truth), map, guess, {}, Parallel(1));
  EXPECT_TRUE(found.converged);
  EXPECT_EQ(found.degenerate_directions, 0);
  EXPECT_LT((found.map_from_lidar.translation() - truth.translation()).norm(), 1e-3);
  EXPECT_LT(so3::angle(truth.linear().transpose() * found.map_from_lidar.linear()), 1e-3);
}

TEST(ArenaSlamRegistration, InATunnelTheWayAlongIsLeftToTheGuess) {
  const std::vector<Eigen::Vector3f> points = walls(1);
  const map::FeatureMap map = map_of(points);
  const Pose truth = make_pose(so3::exp({0.1, 0.0, 0.3}), {0.0, 0.2, -0.4});
  const Pose guess = truth * make_pose(so3::exp({0.02, 0.0, -0.02}), {0.1, -0.08, 0.1});
  const Registration found = register_features(seen(points, truth), map, guess, {}, Parallel(1));
  EXPECT_EQ(found.degenerate_directions, 1);
  EXPECT_NEAR(found.map_from_lidar.translation().x(), guess.translation().x(), 5e-3);
  EXPECT_LT((found.map_from_lidar.translation() - truth.translation()).tail<2>().norm(), 2e-3);
}

TEST(ArenaSlamRegistration, WithTooFewMatchesThePoseIsTheGuess) {
  const map::FeatureMap map = map_of({{0, 0, 1}, {0, 1, 1}, {1, 0, 1}});
  const std::vector<Eigen::Vector3f> points = walls(0);
  const Pose truth = Pose::Identity();
  const Pose guess = make_pose(so3::exp({0.02, 0.0, -0.02}), {0.1, -0.08, 0.1});
  const Registration found = register_features(seen(points, truth), map, guess, {}, Parallel(1));
  EXPECT_EQ(found.iterations, 0);
  EXPECT_LT((found.map_from_lidar.matrix() - guess.matrix()).norm(), 1e-12);
}

TEST(ArenaSlamRegistration, DegeneracyByShareDoesNotDependOnHowManyPointsThereAre) {
  estimation::PoseEquations few;
  const auto add = [&](const Eigen::Vector3d& normal, const Eigen::Vector3d& arm) {
    Eigen::Matrix<double, 1, 6> row;
    row << arm.cross(normal).transpose(), normal.transpose();
    few.add<1>(row, Eigen::Matrix<double, 1, 1>(0.0), 1.0);
  };
  for (const double s : {-3.0, 3.0}) {
    add(Eigen::Vector3d::UnitX(), {s, 1, 1});
    add(Eigen::Vector3d::UnitX(), {s, -1, 2});
    add(Eigen::Vector3d::UnitY(), {1, s, -1});
    add(Eigen::Vector3d::UnitY(), {-1, s, 2});
    add(Eigen::Vector3d::UnitZ(), {2, 1, s});
    add(Eigen::Vector3d::UnitZ(), {-2, 2, s});
  }
  EXPECT_EQ(find_degenerate(few, 3.0).directions, 0);
  estimation::PoseEquations many = few;
  for (int i = 0; i < 100; ++i) many += few;
  EXPECT_EQ(find_degenerate(many, 3.0).directions, 0);
  estimation::PoseEquations tunnel = many;  // hardly anything along x
  tunnel.hessian.row(3) *= 1e-4;
  tunnel.hessian.col(3) *= 1e-4;
  EXPECT_EQ(find_degenerate(tunnel, 3.0).directions, 1);
}

}  // namespace
}  // namespace lidarena::odometry::arena_slam
