// SPDX-License-Identifier: BSD-3-Clause
// The steps of KISS-ICP, each on its own.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "lidarena/base/random.hpp"
#include "lidarena/base/se3.hpp"
#include "lidarena/base/so3.hpp"
#include "lidarena/odometry/kiss_icp/adaptive_threshold.hpp"
#include "lidarena/odometry/kiss_icp/preprocess.hpp"
#include "lidarena/odometry/kiss_icp/registration.hpp"
#include "tests/odometry/synthetic_room.hpp"

namespace lidarena::kiss_icp {
namespace {

using se3::Vector6;

Vector6 vector6(double a, double b, double c, double d, double e, double f) {
  Vector6 v;
  v << a, b, c, d, e, f;
  return v;
}

Pose pose_of(double x, double y, double z, double rx, double ry, double rz) {
  return make_pose(so3::exp({rx, ry, rz}), {x, y, z});
}

/// `count` directions evenly over the sphere (a Fibonacci lattice, turned by `phase`) as points on
/// the walls of the synthetic room seen from `room_from_lidar`, with normal noise of range.
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

VoxelHashMap map_of(std::span<const Eigen::Vector3f> points) {
  VoxelHashMap map({0.5, 4096, 0.0});
  map.insert(points);
  return map;
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
      // h^2 / 6 times a third derivative of up to 41 m, and rounding of 41 m by 1e-16 over h
      EXPECT_LT((slope - residual.jacobian.col(k)).norm(), 3e-9);
    }
  }
}

TEST(Registration, TheSamePointsMovedAreFoundWhereTheyWere) {
  const auto points = look_around(synthetic::flight(0.0), 4000, 0.0, 0.0);
  const VoxelHashMap map = map_of(points);
  // points lie 0.2 m apart and more; a shift of 5 cm pairs nearly all rightly from the start
  const Pose shift = pose_of(0.03, -0.04, 0.02, 0.003, 0.002, -0.004);
  for (const bool sensor_centred : {false, true}) {
    Config config;
    config.convergence = 1e-9;
    config.sensor_centred = sensor_centred;
    const Registration found = register_points(points, map, shift, 0.5, config, Parallel(1));
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
  const VoxelHashMap map = map_of(look_around(first, 200000, 0.0, kNoise));
  const auto keypoints = look_around(first * motion, kKeypoints, 0.7, kNoise);
  Config config;
  config.convergence = 1e-6;
  const Registration found =
      register_points(keypoints, map, Pose::Identity(), 0.5, config, Parallel(1));
  const Pose error = motion.inverse() * found.map_from_lidar;
  // A residual is the noise of two ranges and, along the wall, half the map's spacing of at most
  // 5 cm; of the keypoints a third pulls along each axis. Five standard deviations.
  const double deviation = std::sqrt((2.0 * kNoise * kNoise + 0.025 * 0.025) / (kKeypoints / 3.0));
  EXPECT_LT(error.translation().norm(), 5.0 * deviation);
  EXPECT_LT(so3::angle(error.linear()), 5.0 * deviation / 2.0);  // levers are 2 m and more
  EXPECT_GT(found.matches, kKeypoints * 9 / 10);
}

TEST(Registration, TurningAboutTheSensorOrTheOriginEndsAtTheSamePose) {
  const Pose far_away = pose_of(300.0, -200.0, 20.0, 0.0, 0.0, 1.0);
  std::vector<Eigen::Vector3f> points = look_around(synthetic::flight(0.0), 4000, 0.0, 0.0);
  std::vector<Eigen::Vector3f> moved;
  for (const auto& p : points) moved.push_back((far_away * p.cast<double>()).cast<float>());
  const VoxelHashMap map = map_of(moved);
  const Pose guess = far_away * pose_of(0.03, -0.04, 0.02, 0.003, 0.002, -0.004);
  Config config;
  config.convergence = 1e-7;
  for (const bool sensor_centred : {false, true}) {
    config.sensor_centred = sensor_centred;
    const Registration found = register_points(points, map, guess, 0.5, config, Parallel(1));
    const Pose error = far_away.inverse() * found.map_from_lidar;
    EXPECT_LT(error.translation().norm(), 1e-4) << "floats at 360 m round to 3e-5 m";
    EXPECT_LT(so3::angle(error.linear()), 1e-5);
  }
}

TEST(Registration, WithoutMapOrMatchesTheGuessStands) {
  const auto points = look_around(Pose::Identity(), 500, 0.0, 0.0);
  const Pose guess = pose_of(1.0, 2.0, 3.0, 0.1, 0.2, 0.3);
  const Config config;
  const auto alone = register_points(points, map_of({}), guess, 0.5, config, Parallel(1));
  EXPECT_EQ(alone.map_from_lidar.matrix(), guess.matrix());
  const std::vector<Eigen::Vector3f> elsewhere{{500.0F, 0.0F, 0.0F}};
  const auto lost = register_points(points, map_of(elsewhere), guess, 0.5, config, Parallel(1));
  EXPECT_LT((lost.map_from_lidar.matrix() - guess.matrix()).norm(), 1e-14);
  EXPECT_EQ(lost.matches, 0U);
  EXPECT_EQ(lost.iterations, 1);
}

TEST(AdaptiveThreshold, DisplacementIsHowFarAPointAtTheRangeMoves) {
  // turned about z, the farthest-moved point at 50 m is any one on the x-y circle
  const Pose turned = pose_of(0, 0, 0, 0, 0, 0.3);
  const Eigen::Vector3d point(30.0, 40.0, 0.0);
  EXPECT_NEAR(displacement(turned, 50.0), (turned * point - point).norm(), 1e-12);
  EXPECT_NEAR(displacement(pose_of(3, 0, 4, 0, 0, 0), 50.0), 5.0, 1e-12);
}

TEST(AdaptiveThreshold, SigmaIsTheRootMeanSquareOfTheFirstGuessAndLargeErrors) {
  Config config;
  config.initial_threshold_m = 2.0;
  AdaptiveThreshold threshold(config);
  EXPECT_EQ(threshold.sigma(), 2.0);
  threshold.observe(Pose::Identity(), pose_of(0.09, 0, 0, 0, 0, 0));
  EXPECT_EQ(threshold.sigma(), 2.0) << "below the minimum motion of 0.1 m";
  threshold.observe(Pose::Identity(), pose_of(0.5, 0, 0, 0, 0, 0));
  threshold.observe(pose_of(0, 7, 0, 0, 0, 1), pose_of(0, 8, 0, 0, 0, 1));
  EXPECT_NEAR(threshold.sigma(), std::sqrt((4.0 + 0.25 + 1.0) / 3.0), 1e-12);
}

TEST(AdaptiveThreshold, In2023TheFirstGuessHoldsForHalfAMetreAndThenDropsOut) {
  Config config;
  config.threshold_start = ThresholdStart::kUntilMoved;
  AdaptiveThreshold threshold(config);
  threshold.observe(Pose::Identity(), pose_of(0.3, 0, 0, 0, 0, 0));
  EXPECT_EQ(threshold.sigma(), 2.0) << "0.3 m from the start";
  threshold.observe(pose_of(0.3, 0, 0, 0, 0, 0), pose_of(0.7, 0, 0, 0, 0, 0));
  EXPECT_NEAR(threshold.sigma(), std::sqrt((0.09 + 0.16) / 2.0), 1e-12);
}

Scan scan_of(std::initializer_list<Eigen::Vector3f> positions, std::int32_t step_ns) {
  Scan scan;
  scan.stamp = Time{1000};
  for (const auto& position : positions) {
    Point point;
    point.position = position;
    point.dt_ns = step_ns * static_cast<std::int32_t>(scan.points.size());
    scan.points.push_back(point);
  }
  return scan;
}

TEST(Preprocess, TheRangeGateIsOpenAtBothEndsAndRefusesWhatIsNotFinite) {
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  constexpr float kInfinite = std::numeric_limits<float>::infinity();
  Config config;
  config.min_range_m = 1.0;
  config.max_range_m = 10.0;
  const Scan scan = scan_of({{1, 0, 0},
                             {1.01F, 0, 0},
                             {0, 9.99F, 0},
                             {0, 0, 10},
                             {0, 0, 0},
                             {kNan, 2, 2},
                             {kInfinite, 0, 0}},
                            100);
  const ScanTimes times = times_of(scan, Time{0}, PoseInstant::kScanEnd);
  const auto kept = preprocess(scan, times, Vector6::Zero(), config, Parallel(1));
  ASSERT_EQ(kept.size(), 2U);
  EXPECT_EQ(kept[0], Eigen::Vector3f(1.01F, 0, 0));
  EXPECT_EQ(kept[1], Eigen::Vector3f(0, 9.99F, 0));
}

TEST(Preprocess, APoseBelongsToTheLastPointOrTheMiddleOfTheScan) {
  Scan scan = scan_of({{1, 0, 0}, {1, 0, 0}, {1, 0, 0}}, 300);
  std::swap(scan.points[0], scan.points[2]);  // not in order of time
  EXPECT_EQ(times_of(scan, Time{5}, PoseInstant::kScanEnd).reference, Time{1600});
  EXPECT_EQ(times_of(scan, Time{5}, PoseInstant::kScanMiddle).reference, Time{1300});
  EXPECT_TRUE(times_of(scan, Time{5}, PoseInstant::kScanEnd).timed);
  scan.points.clear();
  EXPECT_EQ(times_of(scan, Time{500}, PoseInstant::kScanEnd).reference, Time{1500});
  EXPECT_FALSE(times_of(scan, Time{500}, PoseInstant::kScanEnd).timed);
}

TEST(Preprocess, EqualTimesLoseTheScanInTheOriginalAndMeanNoTimesWhenCured) {
  const Scan scan = scan_of({{2, 0, 0}, {3, 0, 0}}, 0);
  const ScanTimes times = times_of(scan, Time{0}, PoseInstant::kScanEnd);
  Config config;
  const Pose motion = pose_of(0.1, 0, 0, 0, 0, 0.1);
  const Vector6 twist = twist_within(times, motion, 0.1, config);
  EXPECT_EQ(twist, Vector6::Zero());
  EXPECT_TRUE(preprocess(scan, times, twist, config, Parallel(1)).empty());
  config.equal_times_are_no_times = true;
  EXPECT_EQ(preprocess(scan, times, twist, config, Parallel(1)).size(), 2U);
}

TEST(Preprocess, MotionFillsTheScanInTheOriginalAndTheTimeItTookWhenCured) {
  const Scan scan = scan_of({{2, 0, 0}, {2, 0, 0}}, 50'000'000);  // a scan of 0.05 s
  const ScanTimes times = times_of(scan, Time{0}, PoseInstant::kScanEnd);
  const Vector6 moved = vector6(0.2, 0, 0, 0, 0, 0.1);  // in 0.1 s
  Config config;
  EXPECT_LT((twist_within(times, se3::exp(moved), 0.1, config) - moved / 0.05).norm(), 1e-12);
  config.motion_per_second = true;
  EXPECT_LT((twist_within(times, se3::exp(moved), 0.1, config) - moved / 0.1).norm(), 1e-12);
  config.deskew = false;
  EXPECT_EQ(twist_within(times, se3::exp(moved), 0.1, config), Vector6::Zero());
}

}  // namespace
}  // namespace lidarena::kiss_icp
