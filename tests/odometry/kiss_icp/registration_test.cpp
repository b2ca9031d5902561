// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/odometry/kiss_icp/registration.hpp"

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
std::vector<Eigen::Vector3f> look_around(const Pose& room_from_lidar, std::size_t count,
                                         double phase, double noise) {
  const CounterRandom random(31, static_cast<std::uint32_t>(1000.0 * phase));
  std::vector<Eigen::Vector3f> points;
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

/// ICP of de-skewed points.
Registration register_still(const std::vector<Eigen::Vector3f>& points,
                            const map::VoxelHashMap& map, const Pose& guess, double sigma,
                            const Config& config) {
  return register_points({points, {}}, map, {}, guess, sigma, 0.0, config, Parallel(1));
}

TEST(Registration, JacobianOfTheResidualIsItsNumericDerivative) {
  const Eigen::Vector3d point(3.0, -2.0, 1.0);
  const Eigen::Vector3d counterpart(3.1, -2.2, 1.3);
  for (const Eigen::Vector3d& center :
       {Eigen::Vector3d(0.0, 0.0, 0.0), Eigen::Vector3d(40.0, -7.0, 2.0)}) {
    const auto error = [&](const Vector6& d) -> Eigen::Vector3d {
      return so3::exp(d.tail<3>()) * (point - center) + center + d.head<3>() - counterpart;
    };
    const PointResidual residual = point_to_point(point, counterpart, center);
    EXPECT_EQ(residual.error, error(Vector6::Zero()));
    constexpr double h = 1e-5;
    for (int k = 0; k < 6; ++k) {
      const Eigen::Vector3d slope =
          (error(h * Vector6::Unit(k)) - error(-h * Vector6::Unit(k))) / (2.0 * h);
      // h^2 / 6 times a third derivative of up to 41 m, plus rounding: 41 m times 1e-16 / h
      EXPECT_LT((slope - residual.jacobian.col(k)).norm(), 3e-9);
    }
  }
}

TEST(Registration, TheSamePointsMovedAreFoundWhereTheyWere) {
  const auto points = look_around(synthetic::flight(0.0), 4000, 0.0, 0.0);
  const map::VoxelHashMap map = map_of(points);
  // points are at least 0.2 m apart; with a translation of 5 cm nearly all pairs are right at once
  const Pose shift = pose_of(0.03, -0.04, 0.02, 0.003, 0.002, -0.004);
  for (const bool sensor_centered : {false, true}) {
    Config config;
    config.convergence = 1e-9;
    config.sensor_centered = sensor_centered;
    const Registration found = register_still(points, map, shift, 0.5, config);
    EXPECT_LT((found.map_from_lidar.matrix() - Pose::Identity().matrix()).norm(), 1e-6);
    EXPECT_EQ(found.matches, points.size());
    EXPECT_LT(found.iterations, 50);
  }
}

TEST(Registration, MotionBetweenTwoNoisyScansOfARoomIsFoundToTheNoiseOfItsMean) {
  const Pose first = synthetic::flight(0.0);
  const Pose motion = pose_of(0.12, 0.05, -0.04, 0.01, -0.02, 0.04);
  constexpr double kNoise = 0.01;
  constexpr std::size_t kKeypoints = 2000;
  const map::VoxelHashMap map = map_of(look_around(first, 200000, 0.0, kNoise));
  const auto keypoints = look_around(first * motion, kKeypoints, 0.7, kNoise);
  Config config;
  config.convergence = 1e-6;
  const Registration found = register_still(keypoints, map, Pose::Identity(), 0.5, config);
  const Pose error = motion.inverse() * found.map_from_lidar;
  // A residual has the noise of two ranges and, along the wall, half the map's spacing of at most
  // 5 cm; a third of the keypoints determines each axis. The limit is five standard deviations.
  const double deviation = std::sqrt((2.0 * kNoise * kNoise + 0.025 * 0.025) / (kKeypoints / 3.0));
  EXPECT_LT(error.translation().norm(), 5.0 * deviation);
  EXPECT_LT(so3::angle(error.linear()), 5.0 * deviation / 2.0);  // lever arms are at least 2 m
  EXPECT_GT(found.matches, kKeypoints * 9 / 10);
}

TEST(Registration, TurningAboutTheSensorOrTheOriginEndsAtTheSamePose) {
  const Pose far_away = pose_of(300.0, -200.0, 20.0, 0.0, 0.0, 1.0);
  std::vector<Eigen::Vector3f> points = look_around(synthetic::flight(0.0), 4000, 0.0, 0.0);
  std::vector<Eigen::Vector3f> moved;
  for (const auto& p : points) moved.push_back((far_away * p.cast<double>()).cast<float>());
  const map::VoxelHashMap map = map_of(moved);
  const Pose guess = far_away * pose_of(0.03, -0.04, 0.02, 0.003, 0.002, -0.004);
  Config config;
  config.convergence = 1e-7;
  for (const bool sensor_centered : {false, true}) {
    config.sensor_centered = sensor_centered;
    const Registration found = register_still(points, map, guess, 0.5, config);
    const Pose error = far_away.inverse() * found.map_from_lidar;
    EXPECT_LT(error.translation().norm(), 1e-4) << "floats at 360 m round to 3e-5 m";
    EXPECT_LT(so3::angle(error.linear()), 1e-5);
  }
}

TEST(Registration, WithoutMapOrMatchesTheGuessStands) {
  const auto points = look_around(Pose::Identity(), 500, 0.0, 0.0);
  const Pose guess = pose_of(1.0, 2.0, 3.0, 0.1, 0.2, 0.3);
  const Config config;
  const auto alone = register_still(points, map_of({}), guess, 0.5, config);
  EXPECT_EQ(alone.map_from_lidar.matrix(), guess.matrix());
  const std::vector<Eigen::Vector3f> elsewhere{{500.0F, 0.0F, 0.0F}};
  const auto lost = register_still(points, map_of(elsewhere), guess, 0.5, config);
  EXPECT_LT((lost.map_from_lidar.matrix() - guess.matrix()).norm(), 1e-14);
  EXPECT_EQ(lost.matches, 0U);
  EXPECT_EQ(lost.iterations, 1);
}

/// Points at their own instants, measured while the lidar moves with constant `twist` (per second)
/// during a scan of 0.1 s that ends at `room_from_lidar`.
TimedPoints look_around_moving(const Pose& room_from_lidar, const Vector6& twist,
                               std::size_t count) {
  TimedPoints points;
  for (std::size_t i = 0; i < count; ++i) {
    const double seconds = -0.1 * static_cast<double>(count - 1 - i) / static_cast<double>(count);
    const Pose pose = room_from_lidar * se3::exp(twist * seconds);
    const std::size_t place = i * 7 % count;  // the beam's direction jumps, as with a rosette
    const double z = 1.0 - (2.0 * static_cast<double>(place) + 1.0) / static_cast<double>(count);
    const double azimuth = 2.399963 * static_cast<double>(place);
    const Eigen::Vector3d beam(std::sqrt(1.0 - z * z) * std::cos(azimuth),
                               std::sqrt(1.0 - z * z) * std::sin(azimuth), z);
    points.positions.push_back(
        (synthetic::cast(pose.translation(), pose.linear() * beam) * beam).cast<float>());
    points.seconds.push_back(static_cast<float>(seconds));
  }
  return points;
}

TEST(Registration, MotionWithinTheScanIsFoundWithThePose) {
  // 1.5 m/s and 172 deg/s; prediction and de-skewing start from rest
  const Vector6 twist = vector6(1.2, -0.8, 0.4, 0.5, -0.8, 3.0);
  const Pose start = synthetic::flight(0.0);
  const Pose end = start * se3::exp(0.1 * twist);
  std::vector<Eigen::Vector3f> walls;
  for (const auto& p : look_around(start, 100000, 0.3, 0.0))
    walls.push_back((start * p.cast<double>()).cast<float>());
  const map::VoxelHashMap map = map_of(walls);
  const TimedPoints keypoints = look_around_moving(end, twist, 2003);
  Config config;
  config.sensor_centered = true;
  config.convergence = 1e-6;
  const auto error_with = [&](double scan_motion_share) {
    const auto found = register_points(keypoints, map, {start, 0.1, Vector6::Zero()}, start, 1.0,
                                       scan_motion_share, config, Parallel(1));
    return Pose(end.inverse() * found.map_from_lidar);
  };
  // The map's points are 5 cm apart: residuals of 2.5 cm along the wall; a third of 2000 keypoints
  // determines each axis, each weighted by its share. The limit is five standard deviations.
  const double deviation = 0.025 / std::sqrt(2003.0 / 9.0);
  const Pose own = error_with(1.0);
  EXPECT_LT(own.translation().norm(), 5.0 * deviation);
  EXPECT_LT(so3::angle(own.linear()), 5.0 * deviation / 2.0);  // lever arms are at least 2 m
  EXPECT_GT(so3::angle(error_with(0.0).linear()), 0.1)
      << "without own motion half of the rotation is missed";
  EXPECT_LT(so3::angle(error_with(0.75).linear()), so3::angle(error_with(0.5).linear()));
}

TEST(Registration, TheTwistIsTheShareOfTheOwnMotionAndTheRestOfThatBefore) {
  const Vector6 own = vector6(1.0, 0.2, 0.0, 0.0, 0.3, 2.0);
  const Vector6 before = vector6(0.5, 0.0, 0.1, 0.1, 0.0, 1.0);
  const Pose departed = pose_of(1, 2, 3, 0.1, 0.2, 0.3);
  const PreviousPose previous_pose{departed, 0.2, before};
  const Pose arrived = departed * se3::exp(0.2 * own);
  EXPECT_LT((twist_towards(arrived, previous_pose, 1.0) - own).norm(), 1e-12);
  EXPECT_LT((twist_towards(arrived, previous_pose, 0.0) - before).norm(), 1e-12);
  EXPECT_LT((twist_towards(arrived, previous_pose, 0.75) - (0.75 * own + 0.25 * before)).norm(),
            1e-12);
  EXPECT_EQ(twist_towards(arrived, {departed, 0.0, before}, 1.0), before) << "no time has passed";
}

TEST(Registration, PlanesAverageTheNoiseOfTheirCells) {
  // A noisy wall with points 10 cm apart, and a scan of some of these places with an initial error
  // of 3 cm along the wall and 10 cm across.
  std::vector<Eigen::Vector3f> wall, seen;
  const CounterRandom random(5, 1);
  for (int i = 0; i < 4000; ++i) {
    const auto n = random.normals(static_cast<std::uint64_t>(i));
    const auto y = 0.1F * static_cast<float>(i % 80), z = 0.1F * static_cast<float>(i / 80);
    wall.emplace_back(5.05F + 0.01F * static_cast<float>(n[0]), y, z);
    if (i % 7 == 0) seen.emplace_back(5.05F, y, z);
  }
  const Pose guess = pose_of(0.1, 0.03, 0.0, 0, 0, 0);
  Config config;
  config.sensor_centered = true;
  config.convergence = 1e-7;
  map::VoxelHashMap planes({.voxel_size = 0.5, .max_points = 4096, .plane_thinness = 0.2});
  planes.insert(wall);
  const Registration found = register_still(seen, planes, guess, 1.0, config);
  // the plane of 80 cells is the mean of 500 points with 1 cm of noise
  EXPECT_NEAR(found.map_from_lidar.translation().x(), 0.0, 5.0 * 0.01 / std::sqrt(500.0));
  EXPECT_LT(found.iterations, 10);
}

TEST(Registration, CellsWithoutAShapeDecideOnlyWhatNothingElseDoes) {
  // A corner of three walls with many points per cell; and one point per cell of a pattern that
  // moved with the sensor by 5 cm along each axis, so that its matches pull the pose back.
  std::vector<Eigen::Vector3f> walls, pattern, seen;
  for (int i = 0; i < 60; ++i) {
    for (int k = 0; k < 60; ++k) {
      const float a = 0.05F + 0.1F * static_cast<float>(i),
                  b = 0.05F + 0.1F * static_cast<float>(k);
      for (const Eigen::Vector3f& p : {Eigen::Vector3f(0.05F, a, b), Eigen::Vector3f(a, 0.05F, b),
                                       Eigen::Vector3f(a, b, 0.05F)}) {
        walls.push_back(p);
        if ((i + k) % 5 == 0) seen.push_back(p);
      }
    }
  }
  for (int i = 0; i < 1000; ++i) {
    const Eigen::Vector3f there(10.25F + 0.5F * static_cast<float>(i % 10),
                                10.25F + 0.5F * static_cast<float>(i / 10 % 10),
                                10.25F + 0.5F * static_cast<float>(i / 100));
    pattern.push_back(there);
    seen.emplace_back(there.array() - 0.05F);
  }
  map::VoxelHashMap corner({.voxel_size = 0.5, .max_points = 4096, .plane_thinness = 0.2});
  corner.insert(walls);
  corner.insert(pattern);
  map::VoxelHashMap alone({.voxel_size = 0.5, .max_points = 4096, .plane_thinness = 0.2});
  alone.insert(pattern);
  Config config;
  config.sensor_centered = true;
  config.convergence = 1e-7;
  const auto shift_in = [&](const map::VoxelHashMap& map, double weight) -> double {
    config.degenerate_cell_weight = weight;
    return register_still(seen, map, Pose::Identity(), 0.5, config)
        .map_from_lidar.translation()
        .norm();
  };
  EXPECT_GT(shift_in(corner, 1.0), 0.01);
  EXPECT_LT(shift_in(corner, 1e-4), 1e-4);
  // without other points they determine the pose, up to the convergence threshold
  EXPECT_NEAR(shift_in(alone, 1.0), 0.05 * std::sqrt(3.0), 1e-5);
  EXPECT_NEAR(shift_in(alone, 1e-4), 0.05 * std::sqrt(3.0), 1e-5);
}

TEST(Registration, TheKernelsScaleIsALengthOrTheRootOfOne) {
  // Each point of the map is seen three times in place and once 5 cm off: by symmetry there is no
  // rotation, and the translation x solves 3 w(x) x + w(x - d) (x - d) = 0, w(r) = (k / (k +
  // r^2))^2.
  constexpr double kOff = 0.05, kSigma = 0.1, kFraction = 0.5;
  std::vector<Eigen::Vector3f> points, seen;
  for (int i = 0; i < 216; ++i) {
    points.emplace_back(static_cast<float>(i % 6) - 2.5F, static_cast<float>(i / 6 % 6) - 2.5F,
                        static_cast<float>(i / 36) - 2.5F);
    for (int copy = 0; copy < 3; ++copy) seen.push_back(points.back());
    seen.emplace_back(points.back() - Eigen::Vector3f(static_cast<float>(kOff), 0.0F, 0.0F));
  }
  for (const bool in_meters : {false, true}) {
    const double scale = kSigma * kFraction;
    const double k = in_meters ? scale * scale : scale;
    const auto slope = [&](double x) {
      const auto pull = [&](double r) { return r * std::pow(k / (k + r * r), 2.0); };
      return 3.0 * pull(x) + pull(x - kOff);
    };
    double low = 0.0, high = 0.25 * kOff;  // without a kernel it would be a quarter
    for (int i = 0; i < 60; ++i)
      (slope(0.5 * (low + high)) < 0.0 ? low : high) = 0.5 * (low + high);
    Config config;
    config.sensor_centered = true;
    config.convergence = 1e-9;
    config.kernel_fraction = kFraction;
    config.kernel_scale_in_meters = in_meters;
    const auto found = register_still(seen, map_of(points), Pose::Identity(), kSigma, config);
    EXPECT_NEAR(found.map_from_lidar.translation().x(), low, 1e-7) << in_meters;
    EXPECT_LT(found.map_from_lidar.translation().tail<2>().norm(), 1e-7);
  }
}

TEST(Registration, KeypointsAtThePosesInstantAreTheSameMovingOrNot) {
  const auto points = look_around(synthetic::flight(0.0), 2000, 0.0, 0.0);
  const map::VoxelHashMap map = map_of(points);
  const Pose shift = pose_of(0.03, -0.04, 0.02, 0.003, 0.002, -0.004);
  Config config;
  config.sensor_centered = true;
  const std::vector<float> all_at_it(points.size(), 0.0F);
  const PreviousPose previous_pose{pose_of(1, 2, 3, 0, 0, 1), 0.1, Vector6::Zero()};
  const auto moving = register_points({points, all_at_it}, map, previous_pose, shift, 0.5, 1.0,
                                      config, Parallel(1));
  const auto still = register_still(points, map, shift, 0.5, config);
  EXPECT_LT((moving.map_from_lidar.matrix() - still.map_from_lidar.matrix()).norm(), 1e-12);
}

}  // namespace
}  // namespace lidarena::odometry::kiss_icp
