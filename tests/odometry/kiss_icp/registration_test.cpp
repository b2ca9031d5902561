// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/odometry/kiss_icp_steps.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "lidarena/base/random.hpp"
#include "lidarena/base/se3.hpp"
#include "lidarena/base/so3.hpp"
#include "tests/odometry/kiss_icp/motions.hpp"
#include "tests/odometry/synthetic_room.hpp"

namespace lidarena::odometry::kiss_icp {
namespace {

using se3::Vector6;

/// Points on the walls of the synthetic room seen from `room_from_lidar` in `count` directions
/// evenly over the sphere (a Fibonacci lattice, rotated by `phase`), with normal range noise (m).
Points look_around(const Pose& room_from_lidar, std::size_t count, double phase, double noise) {
  const CounterRandom random(31, static_cast<std::uint32_t>(1000.0 * phase));
  Points points;
  for (std::size_t i = 0; i < count; ++i) {
    const double z = 1.0 - (2.0 * static_cast<double>(i) + 1.0) / static_cast<double>(count);
    const double azimuth = 2.399963 * static_cast<double>(i) + phase;  // golden angle, rad
    const Eigen::Vector3d beam(std::sqrt(1.0 - z * z) * std::cos(azimuth),
                               std::sqrt(1.0 - z * z) * std::sin(azimuth), z);
    const double range =
        synthetic::cast(room_from_lidar.translation(), room_from_lidar.linear() * beam) +
        noise * random.normals(i)[0];
    points.push_back((range * beam).cast<float>());
  }
  return points;
}

map::VoxelHashMap map_of(std::span<const Eigen::Vector3f> points) {
  map::VoxelHashMap map({.voxel_size = 0.5, .max_points = 4096});
  map.insert(points);
  return map;
}

Registration register_to(const map::VoxelHashMap& map, const Points& points, const Pose& guess,
                         double convergence) {
  Config config;
  config.convergence = convergence;
  return register_points(points, map, guess, icp_limits(0.5, 0.5, config), Parallel(1));
}

TEST(Registration, JacobianOfTheResidualIsItsNumericDerivative) {
  const Eigen::Vector3d point(3.0, -2.0, 1.0);
  const Eigen::Vector3d counterpart(3.1, -2.2, 1.3);
  const auto error = [&](const Vector6& d) -> Eigen::Vector3d {
    return so3::exp(d.tail<3>()) * point + d.head<3>() - counterpart;
  };
  const PointResidual residual = point_to_point(point, counterpart);
  EXPECT_EQ(residual.error, error(Vector6::Zero()));
  constexpr double h = 1e-5;
  for (int k = 0; k < 6; ++k) {
    const Eigen::Vector3d slope =
        (error(h * Vector6::Unit(k)) - error(-h * Vector6::Unit(k))) / (2.0 * h);
    // h^2 / 6 times a third derivative of up to 4 m, plus rounding: 4 m times 1e-16 / h
    EXPECT_LT((slope - residual.jacobian.col(k)).norm(), 3e-10);
  }
}

TEST(Registration, TheSamePointsMovedAreFoundWhereTheyWere) {
  const auto points = look_around(synthetic::flight(0.0), 4000, 0.0, 0.0);
  // points are at least 0.2 m apart; with a translation of 5 cm nearly all pairs are right at once
  const Pose shift = pose_of(0.03, -0.04, 0.02, 0.003, 0.002, -0.004);
  const Registration found = register_to(map_of(points), points, shift, 1e-9);
  EXPECT_LT((found.map_from_lidar.matrix() - Pose::Identity().matrix()).norm(), 1e-6);
  EXPECT_EQ(found.matches, points.size());
  EXPECT_LT(found.iterations, 50);
}

TEST(Registration, MotionBetweenTwoNoisyScansOfARoomIsFoundToTheNoiseOfItsMean) {
  const Pose first = synthetic::flight(0.0);
  const Pose motion = pose_of(0.12, 0.05, -0.04, 0.01, -0.02, 0.04);
  constexpr double kNoise = 0.01;
  constexpr std::size_t kKeypoints = 2000;
  const map::VoxelHashMap map = map_of(look_around(first, 200000, 0.0, kNoise));
  const auto keypoints = look_around(first * motion, kKeypoints, 0.7, kNoise);
  const Registration found = register_to(map, keypoints, Pose::Identity(), 1e-6);
  const Pose error = motion.inverse() * found.map_from_lidar;
  // A residual has the noise of two ranges and, along the wall, half the map's spacing of at most
  // 5 cm; a third of the keypoints determines each axis. The limit is five standard deviations.
  const double deviation = std::sqrt((2.0 * kNoise * kNoise + 0.025 * 0.025) / (kKeypoints / 3.0));
  EXPECT_LT(error.translation().norm(), 5.0 * deviation);
  EXPECT_LT(so3::angle(error.linear()), 5.0 * deviation / 2.0);  // lever arms are at least 2 m
  EXPECT_GT(found.matches, kKeypoints * 9 / 10);
}

TEST(Registration, FarFromTheOriginTheSamePoseIsFound) {
  // rotation increments are about the origin of the map, 360 m away
  const Pose far_away = pose_of(300.0, -200.0, 20.0, 0.0, 0.0, 1.0);
  const Points points = look_around(synthetic::flight(0.0), 4000, 0.0, 0.0);
  const map::VoxelHashMap map = map_of(transformed(far_away, points));
  const Pose guess = far_away * pose_of(0.03, -0.04, 0.02, 0.003, 0.002, -0.004);
  const Registration found = register_to(map, points, guess, 1e-7);
  const Pose error = far_away.inverse() * found.map_from_lidar;
  EXPECT_LT(error.translation().norm(), 1e-4) << "floats at 360 m round to 3e-5 m";
  EXPECT_LT(so3::angle(error.linear()), 1e-5);
}

TEST(Registration, WithoutMapOrMatchesTheGuessStands) {
  const auto points = look_around(Pose::Identity(), 500, 0.0, 0.0);
  const Pose guess = pose_of(1.0, 2.0, 3.0, 0.1, 0.2, 0.3);
  const auto alone = register_to(map_of({}), points, guess, 1e-4);
  EXPECT_EQ(alone.map_from_lidar.matrix(), guess.matrix());
  const Points elsewhere{{500.0F, 0.0F, 0.0F}};
  const auto lost = register_to(map_of(elsewhere), points, guess, 1e-4);
  EXPECT_LT((lost.map_from_lidar.matrix() - guess.matrix()).norm(), 1e-14);
  EXPECT_EQ(lost.matches, 0U);
  EXPECT_EQ(lost.iterations, 1);
}

TEST(Registration, IterationsEndAtTheirMaximum) {
  const auto points = look_around(synthetic::flight(0.0), 500, 0.0, 0.0);
  const Pose shift = pose_of(0.3, -0.2, 0.2, 0.03, 0.02, -0.04);
  Config config;
  config.max_iterations = 3;
  config.convergence = 0.0;
  const auto found =
      register_points(points, map_of(points), shift, icp_limits(0.5, 0.5, config), Parallel(1));
  EXPECT_EQ(found.iterations, 3);
}

TEST(Registration, TheSearchRadiusIsThreeSigma) {
  const IcpLimits limits = icp_limits(0.3, 0.1, Config{});
  EXPECT_NEAR(limits.max_distance_m, 0.9, 1e-15);
  EXPECT_EQ(limits.kernel_scale, 0.1);
  EXPECT_EQ(kernel_weight(0.0, 0.1), 1.0);
  EXPECT_NEAR(kernel_weight(0.1, 0.1), 0.25, 1e-15) << "at a residual of the root of 0.1 m";
}

TEST(Registration, EachResidualHasTheWeightOfTheKernel) {
  // Each point of the map is seen three times in place and once 5 cm off: by symmetry there is no
  // rotation, and the translation x solves 3 w(x) x + w(x - d) (x - d) = 0, w(r) = (k / (k +
  // r^2))^2.
  constexpr double kOff = 0.05, kScale = 0.003;
  Points points, seen;
  for (int i = 0; i < 216; ++i) {
    points.emplace_back(static_cast<float>(i % 6) - 2.5F, static_cast<float>(i / 6 % 6) - 2.5F,
                        static_cast<float>(i / 36) - 2.5F);
    for (int copy = 0; copy < 3; ++copy) seen.push_back(points.back());
    seen.emplace_back(points.back() - Eigen::Vector3f(static_cast<float>(kOff), 0.0F, 0.0F));
  }
  const auto slope = [&](double x) {
    const auto pull = [&](double r) { return r * std::pow(kScale / (kScale + r * r), 2.0); };
    return 3.0 * pull(x) + pull(x - kOff);
  };
  double low = 0.0, high = 0.25 * kOff;  // without a kernel it would be a quarter
  for (int i = 0; i < 60; ++i) (slope(0.5 * (low + high)) < 0.0 ? low : high) = 0.5 * (low + high);
  ASSERT_LT(low, 0.2 * kOff);
  const IcpLimits limits{0.3, kScale, 500, 1e-9};
  const auto found = register_points(seen, map_of(points), Pose::Identity(), limits, Parallel(1));
  EXPECT_NEAR(found.map_from_lidar.translation().x(), low, 1e-7);
  EXPECT_LT(found.map_from_lidar.translation().tail<2>().norm(), 1e-7);
}

}  // namespace
}  // namespace lidarena::odometry::kiss_icp
