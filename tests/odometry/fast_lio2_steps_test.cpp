// SPDX-License-Identifier: BSD-3-Clause
// Tests of the single steps of FAST-LIO2.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "lidarena/base/random.hpp"
#include "lidarena/base/so3.hpp"
#include "lidarena/base/time.hpp"
#include "lidarena/odometry/fast_lio2/initialization.hpp"
#include "lidarena/odometry/fast_lio2/local_map.hpp"
#include "lidarena/odometry/fast_lio2/plane_residuals.hpp"

namespace lidarena::odometry::fast_lio2 {
namespace {

Eigen::Vector3d random_vector(SequentialRandom& random, double sigma) {
  const double x = random.normal();
  const double y = random.normal();
  return sigma * Eigen::Vector3d(x, y, random.normal());
}

ImuSample sample_at(double t, const Eigen::Vector3d& gyro = Eigen::Vector3d::Zero(),
                    const Eigen::Vector3d& accel = {0.0, 0.0, 9.80665}) {
  return {from_seconds(t), gyro, accel};
}

// --- Start ---

std::vector<ImuSample> standing(double accel_unit, double noise) {
  SequentialRandom random(9, 1);
  const Eigen::Matrix3d tilt = so3::exp({0.1, -0.2, 0.0});
  std::vector<ImuSample> samples;
  for (int i = 0; i < 20; ++i) {
    const Eigen::Vector3d force = tilt.transpose() * Eigen::Vector3d(0, 0, 9.80665);
    samples.push_back(sample_at(0.005 * i,
                                Eigen::Vector3d(0.01, 0, 0) + random_vector(random, noise),
                                accel_unit * (force + random_vector(random, 10 * noise))));
  }
  return samples;
}

Config improved_config() {
  LidarInfo lidar;
  return indoor(lidar);
}

TEST(FastLio2Start, GravityAndBiasComeFromTheMeans) {
  const Start start = start_from(standing(1.0, 1e-3), Pose::Identity(), improved_config());
  EXPECT_TRUE(start.still);
  EXPECT_EQ(start.accel_scale, 1.0);
  const Eigen::Vector3d down = so3::exp({0.1, -0.2, 0.0}).transpose() * Eigen::Vector3d(0, 0, -1);
  EXPECT_LT((start.estimate.state.gravity.normalized() - down).norm(), 2e-3);
  EXPECT_NEAR(start.estimate.state.gravity.norm(), 9.80665, 1e-9);
  EXPECT_NEAR(start.estimate.state.nav.bias.gyro.x(), 0.01, 1e-3);
}

TEST(FastLio2Start, AccelerationsInGAreRecognized) {
  const Start start =
      start_from(standing(1.0 / 9.80665, 1e-3), Pose::Identity(), improved_config());
  EXPECT_DOUBLE_EQ(start.accel_scale, 9.80665);
  EXPECT_TRUE(start.still);
}

/// Samples of a sensor at rest with a bias of the accelerometer as large as data sheets allow.
std::vector<ImuSample> standing_with(const Eigen::Vector3d& accel_bias) {
  std::vector<ImuSample> samples = standing(1.0, 1e-3);
  for (ImuSample& sample : samples) sample.accel += accel_bias;
  return samples;
}

TEST(FastLio2Start, AnAccelerometersBiasIsNotTakenForMotion) {
  const Config config = improved_config();
  for (const double bias : {-0.2, -0.07, 0.07, 0.2}) {
    const Eigen::Matrix3d tilt = so3::exp({0.1, -0.2, 0.0});
    const Eigen::Vector3d up = tilt.transpose() * Eigen::Vector3d::UnitZ();
    const std::vector<ImuSample> samples = standing_with(bias * up);
    const estimation::InertialState state =
        start_from(samples, Pose::Identity(), config).estimate.state;
    // The mean of 20 samples with 0.01 m/s^2 of noise: 4.5 sigma.
    EXPECT_LT((state.nav.bias.accel - bias * up).norm(), 0.01);
    StillDetector detector;
    EXPECT_TRUE(
        detector.observe(estimation::statistics(samples), state, state.position(), config, 1.0));
  }
}

TEST(FastLio2Start, ShakingIsNotStanding) {
  const Start start = start_from(standing(1.0, 0.1), Pose::Identity(), improved_config());
  EXPECT_FALSE(start.still);
  EXPECT_EQ(start.estimate.state.nav.bias.gyro, Eigen::Vector3d::Zero().eval());
  EXPECT_GT(start.estimate.covariance(estimation::InertialState::kVelocity,
                                      estimation::InertialState::kVelocity),
            1.0);
}

TEST(FastLio2Start, SlowMotionEndsTheStanding) {
  StillDetector detector;
  const Config config = improved_config();
  const estimation::ImuStatistics imu = estimation::statistics(standing(1.0, 1e-3));
  estimation::InertialState state;
  state.nav.bias.gyro = {0.01, 0.0, 0.0};
  state.gravity = so3::exp({0.1, -0.2, 0.0}).transpose() * state.gravity;
  int stood = 0;
  for (int i = 0; i < 20; ++i) {
    state.position().x() = 0.004 * i;  // 4 cm/s: not observable by an IMU
    state.nav.velocity.x() = 0.04;
    stood += detector.observe(imu, state, state.position(), config, 1.0) ? 1 : 0;
  }
  EXPECT_LT(stood, 19) << "motion should be detected every 3 cm";
  EXPECT_GT(stood, 10);
}

TEST(FastLio2Start, TheFirstPushEndsTheStanding) {
  const Config config = improved_config();
  estimation::InertialState state;
  state.nav.bias.gyro = {0.01, 0.0, 0.0};
  state.gravity = so3::exp({0.1, -0.2, 0.0}).transpose() * state.gravity;
  std::vector<ImuSample> samples = standing(1.0, 1e-3);
  StillDetector detector;
  EXPECT_TRUE(
      detector.observe(estimation::statistics(samples), state, state.position(), config, 1.0));
  for (ImuSample& sample : samples) sample.accel.x() += 0.1;
  EXPECT_FALSE(
      detector.observe(estimation::statistics(samples), state, state.position(), config, 1.0))
      << "acceleration of 0.1 m/s^2";
}

// --- Planes ---

Neighbors points_on(const Eigen::Vector3d& normal, double offset, double thickness,
                    SequentialRandom& random) {
  const auto basis = estimation::tangent_basis(normal);
  Neighbors points;
  for (map::Neighbor& point : points) {
    const Eigen::Vector2d along(random.uniform(-0.3, 0.3), random.uniform(-0.3, 0.3));
    point.point = (normal * (-offset + thickness * (2.0 * random.uniform() - 1.0)) + basis * along)
                      .cast<float>();
  }
  return points;
}

TEST(FastLio2Planes, AreFoundByBothFits) {
  SequentialRandom random(3, 1);
  for (int i = 0; i < 50; ++i) {
    const Eigen::Vector3d normal = random_vector(random, 1.0).normalized();
    const Neighbors points = points_on(normal, -3.0, 0.0, random);
    for (const estimation::PlaneFit fit :
         {estimation::PlaneFit::kUnitOffset, estimation::PlaneFit::kPrincipal}) {
      const auto plane = estimation::fit_plane(map::columns_of(points), fit, 0.1);
      ASSERT_TRUE(plane.has_value());
      EXPECT_NEAR(std::abs(plane->normal.dot(normal)), 1.0, 1e-4);
      EXPECT_NEAR(std::abs(plane->offset), 3.0, 1e-2);
    }
  }
}

TEST(FastLio2Planes, ThroughTheOriginTheOriginalFindsNone) {
  SequentialRandom random(4, 1);
  int found = 0;
  for (int i = 0; i < 50; ++i) {
    const Eigen::Vector3d normal = random_vector(random, 1.0).normalized();
    const Neighbors points = points_on(normal, 0.0, 0.0, random);
    const auto plane =
        estimation::fit_plane(map::columns_of(points), estimation::PlaneFit::kPrincipal, 0.1);
    ASSERT_TRUE(plane.has_value());
    EXPECT_GT(std::abs(plane->normal.dot(normal)), 0.999);
    const auto other =
        estimation::fit_plane(map::columns_of(points), estimation::PlaneFit::kUnitOffset, 0.1);
    found += other && std::abs(other->normal.dot(normal)) > 0.9 ? 1 : 0;
  }
  EXPECT_LT(found, 25) << "a fault that `principal` does not have; noise of 1 cm hides it";
}

TEST(FastLio2Planes, ThickOnesAreRefused) {
  SequentialRandom random(5, 1);
  const Neighbors points = points_on({0.0, 0.0, 1.0}, -2.0, 0.5, random);
  EXPECT_FALSE(
      estimation::fit_plane(map::columns_of(points), estimation::PlaneFit::kPrincipal, 0.01)
          .has_value());
  Neighbors same;
  for (map::Neighbor& point : same) point.point.setZero();
  EXPECT_FALSE(estimation::fit_plane(map::columns_of(same), estimation::PlaneFit::kUnitOffset, 0.1)
                   .has_value())
      << "not finite";
}

/// A cross with arms `length` and `width` (m) in a tilted plane, with noise `sigma` across it.
Neighbors cross(double length, double width, double sigma, SequentialRandom& random) {
  const Eigen::Matrix3d turn = so3::exp({0.4, -0.3, 0.9});
  Neighbors points;
  const double arms[5][2] = {{0, 0}, {length, 0}, {-length, 0}, {0, width}, {0, -width}};
  for (std::size_t i = 0; i < 5; ++i) {
    const Eigen::Vector3d at(arms[i][0], arms[i][1], 5.0 + sigma * random.normal());
    points[i].point = (turn * at).cast<float>();
  }
  return points;
}

TEST(FastLio2Planes, TheVarianceIsThatOfManyFits) {
  SequentialRandom random(12, 1);
  constexpr double kSigma = 0.01;
  constexpr double kLength = 0.3;
  constexpr int kFits = 4000;
  const Eigen::Matrix3d turn = so3::exp({0.4, -0.3, 0.9});
  for (const double width : {0.08, 0.15, 0.25}) {
    // In the direction that is determined worst, at the distance of the farthest point.
    const Eigen::Vector3d end = turn * Eigen::Vector3d(0.0, kLength, 5.0);
    double squares = 0.0;
    for (int i = 0; i < kFits; ++i) {
      const auto plane =
          estimation::fit_plane(map::columns_of(cross(kLength, width, kSigma, random)),
                                estimation::PlaneFit::kPrincipal, 0.1);
      ASSERT_TRUE(plane.has_value());
      squares += std::pow(plane->normal.dot(end) + plane->offset, 2);
    }
    const Neighbors exact = cross(kLength, width, 0.0, random);
    const auto plane =
        estimation::fit_plane(map::columns_of(exact), estimation::PlaneFit::kPrincipal, 0.1);
    const double predicted_variance = plane_variance(exact, *plane, kSigma * kSigma);
    const double tilt = kSigma * kSigma / (2.0 * width * width);
    EXPECT_NEAR(predicted_variance, kSigma * kSigma / 5.0 + tilt * kLength * kLength,
                1e-3 * predicted_variance);
    // 4000 squares give a variance to 2.2 %; the rest is the second order of the fit.
    EXPECT_NEAR(squares / kFits, predicted_variance, 0.1 * predicted_variance) << "width " << width;
  }
}

TEST(FastLio2Planes, OfPointsOnALineNothingIsKnown) {
  SequentialRandom random(13, 1);
  const Neighbors line = cross(0.3, 0.0, 0.0, random);
  const auto plane =
      estimation::fit_plane(map::columns_of(line), estimation::PlaneFit::kPrincipal, 0.1);
  ASSERT_TRUE(plane.has_value());
  EXPECT_GT(plane_variance(line, *plane, 1e-3), 1.0) << "m^2; large but finite";
  EXPECT_LT(plane_variance(line, *plane, 1e-3), 1e3);
}

TEST(FastLio2Planes, TheJacobianIsTheNumericOne) {
  SequentialRandom random(6, 1);
  for (int i = 0; i < 50; ++i) {
    estimation::InertialState state;
    state.position() = random_vector(random, 3.0);
    state.rotation() = so3::exp(random_vector(random, 1.0));
    state.imu_from_lidar.linear() = so3::exp(random_vector(random, 1.0));
    state.imu_from_lidar.translation() = random_vector(random, 0.2);
    const Eigen::Vector3d point = random_vector(random, 5.0);
    const estimation::Plane plane{random_vector(random, 1.0).normalized(), random.normal()};
    const PointResidual residual = point_residual(point, plane, state, true);
    EXPECT_NEAR(residual.distance,
                plane.normal.dot(state.world_from_lidar() * point) + plane.offset, 1e-12);
    for (Eigen::Index k = 0; k < estimation::kPointDof; ++k) {
      const estimation::InertialState::Vector step =
          1e-6 * estimation::InertialState::Vector::Unit(k);
      const double slope =
          (point_residual(point, plane, estimation::plus(state, step), true).distance -
           point_residual(point, plane, estimation::plus(state, -step), true).distance) /
          2e-6;
      EXPECT_NEAR(residual.row[k], slope, 1e-8);
    }
    EXPECT_EQ(point_residual(point, plane, state, false).row.tail<6>().norm(), 0.0);
  }
}

TEST(FastLio2Planes, ResidualsAreGatedByRangeAndKeptUntilTheNextSearch) {
  map::KdTree map;
  for (int x = -20; x <= 20; ++x) {
    for (int y = -20; y <= 20; ++y) {
      map.insert({0.2F * static_cast<float>(x), 0.2F * static_cast<float>(y), 0.0F});
    }
  }
  const std::vector<Eigen::Vector3f> points{{0.05F, 0.03F, 1.0F}};  // 1 m below: gate 0.111 m
  Config config;
  config.plane_fit = estimation::PlaneFit::kPrincipal;
  const Parallel parallel(1);
  PlaneResiduals residuals(points, map, config, parallel);
  estimation::InertialState state;
  state.position().z() = -0.9;
  const auto near = residuals(state, true);
  ASSERT_EQ(near.count, 1U);
  EXPECT_NEAR(near.cost, 0.5 * 0.1 * 0.1, 1e-6);
  state.position().z() = -0.88;
  EXPECT_EQ(residuals(state, false).count, 0U) << "0.12 m away";
  state.position().z() = -0.95;
  EXPECT_EQ(residuals(state, false).count, 0U) << "out until the next search";
  EXPECT_EQ(residuals(state, true).count, 1U);
}

// --- Map ---

TEST(FastLio2Map, ShortcutsOfInsertionDoNotChangeWhatACellKeeps) {
  SequentialRandom random(8, 1);
  map::KdTree with_shortcuts;
  map::KdTree without;
  const auto random_point = [&] {
    return Eigen::Vector3f(random_vector(random, 0.7).cast<float>());
  };
  for (int scan = 0; scan < 30; ++scan) {
    std::vector<Eigen::Vector3f> points;
    for (int i = 0; i < 100; ++i) points.push_back(random_point());
    std::vector<Match> matches(points.size());
    for (std::size_t i = 0; i < points.size(); ++i) {
      matches[i].found = with_shortcuts.nearest(points[i], matches[i].neighbors, 2.0F);
    }
    add_scan(points, matches, 0.5F, with_shortcuts);
    add_scan(points, {}, 0.5F, without);
  }
  // Without neighbors each cell keeps its best point. The neighbors are those of the map before the
  // scan and also from other cells, so a few better points are rejected and a few extra ones
  // inserted.
  EXPECT_NEAR(static_cast<double>(with_shortcuts.size()), static_cast<double>(without.size()),
              0.2 * static_cast<double>(without.size()));
}

TEST(FastLio2Map, FollowsTheSensor) {
  map::KdTree map;
  for (int i = -100; i <= 100; ++i) map.insert({static_cast<float>(i), 0.0F, 0.0F});
  MapWindow window(40.0);
  window.follow({5.0F, 0.0F, 0.0F}, map);
  EXPECT_EQ(map.size(), 201U) << "less than a quarter of 40 m";
  window.follow({20.0F, 0.0F, 0.0F}, map);
  EXPECT_EQ(map.size(), 79U) << "-19 .. 59";
  for (const Eigen::Vector3f& point : map.points()) {
    EXPECT_GT(point.x(), -20.5F);
    EXPECT_LT(point.x(), 60.5F);
  }
}

}  // namespace
}  // namespace lidarena::odometry::fast_lio2
