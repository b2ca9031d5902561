// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/odometry/arena_lo/registration.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "lidarena/base/random.hpp"
#include "lidarena/base/so3.hpp"

namespace lidarena::odometry::arena_lo {
namespace {

const Parallel& single_thread() {
  static const Parallel parallel(1);
  return parallel;
}

/// Three walls and a floor about the origin, seen from there.
map::LocalPlanes arena_lo_corner_map() {
  map::LocalPlanes map(Config{}.map.options());
  std::vector<Eigen::Vector3f> points;
  for (int i = -60; i < 60; ++i) {
    for (int k = -60; k < 60; ++k) {
      const float a = static_cast<float>(i) / 20.0F;
      const float b = static_cast<float>(k) / 20.0F;
      points.emplace_back(3.0F, a, b);
      points.emplace_back(a, 3.0F, b);
      points.emplace_back(a, b, -3.0F);
    }
  }
  map.insert(points, Eigen::Vector3f(0, 0, 0));
  return map;
}

estimation::MotionEstimate arena_lo_prior(double pose_sigma) {
  estimation::MotionEstimate prior;
  prior.covariance.diagonal() << Eigen::Matrix<double, 6, 1>::Constant(pose_sigma * pose_sigma),
      Eigen::Matrix<double, 6, 1>::Constant(1e-2), Eigen::Matrix<double, 6, 1>::Constant(1.0);
  return prior;
}

/// Cost of one point, of which the kernel's weight is held at 1.
double signed_distance(const Eigen::Vector3f& point, const estimation::MotionState& state) {
  return (state.pose * point.cast<double>()).x() - 3.0;
}

TEST(ArenaLoRegistration, TheRowIsTheNumericDerivativeOfTheDistance) {
  const map::LocalPlanes map = arena_lo_corner_map();
  estimation::MotionEstimate at = arena_lo_prior(1e-4);
  at.state.pose = make_pose(so3::exp({0.02, -0.03, 0.05}), {0.004, 0.01, -0.02});
  const Eigen::Vector3f point(2.95F, 0.7F, 0.4F);
  const Config config;
  const Measurement found = measure({&point, 1}, at, 10.0, map, config, single_thread());
  ASSERT_EQ(found.near_planes, 1U);
  const double scale = std::sqrt(found.equations.hessian.topLeftCorner<3, 3>().trace());
  Eigen::Matrix<double, 6, 1> numeric;
  for (int i = 0; i < 6; ++i) {
    constexpr double kStep = 1e-6;
    const estimation::MotionVector step = kStep * estimation::MotionVector::Unit(i);
    numeric[i] =
        (signed_distance(point, at.state + step) - signed_distance(point, at.state + (-step))) /
        (2.0 * kStep);
  }
  const Eigen::Matrix<double, 6, 6> expected = scale * scale * numeric * numeric.transpose();
  EXPECT_LT((found.equations.hessian - expected).norm(), 1e-3 * expected.norm());
  const double distance = signed_distance(point, at.state);
  EXPECT_LT((found.equations.gradient - scale * scale * distance * numeric).norm(),
            1e-3 * scale * scale * std::abs(distance) * numeric.norm() + 1e-6);
}

TEST(ArenaLoRegistration, AnUncertainPoseWidensTheKernelAndTheVariance) {
  const map::LocalPlanes map = arena_lo_corner_map();
  const Eigen::Vector3f off(2.9F, 0.7F, 0.4F);
  const Config config;
  const auto weight = [&](double sigma) {
    const estimation::MotionEstimate at = arena_lo_prior(sigma);
    return measure({&off, 1}, at, config.kernel_scale_m, map, config, single_thread())
        .equations.hessian(0, 0);
  };
  const double kernel = 1.0 / std::pow(1.0 + 0.1 * 0.1 / (0.05 * 0.05), 2);
  EXPECT_NEAR(weight(1e-4), kernel / config.point_variance_m2, 1.0);
  EXPECT_GT(weight(0.03), 1.5 * weight(1e-4)) << "0.03 m and rad: 10 cm of the point";
  EXPECT_LT(weight(1.0), weight(0.03)) << "what may be meters off says little";
}

/// What a sensor with this motion measures of the walls of the corner, in 0.1 s, by random rays.
std::vector<Slice> arena_lo_corner_scan(const estimation::MotionState& at_begin, double noise) {
  SequentialRandom random(6, 1);
  Scan scan{.stamp = Time{1'000'000'000}, .points = {}, .timed = true};
  for (int i = 0; i < 8000; ++i) {
    const double seconds = 0.1 * i / 8000.0;
    const Pose pose = at_begin.pose_after(seconds);
    const Eigen::Vector3d beam(random.normal(), random.normal(), random.normal());
    const Eigen::Vector3d there = pose.linear() * beam.normalized();
    const Eigen::Vector3d walls(3.0, 3.0, -3.0);
    const Eigen::Array3d ranges = (walls - pose.translation()).array() / there.array();
    double range = 1e9;
    for (const double r : ranges) range = r > 0.0 ? std::min(range, r) : range;
    if (range > 4.5) continue;
    range += noise * random.normal();
    scan.points.push_back(
        {(range * beam.normalized()).cast<float>(), 0, static_cast<std::int32_t>(1e9 * seconds)});
  }
  return slices_of(scan, estimation::times_of(scan, Time{100'000'000}), 0.005, Config{});
}

TEST(ArenaLoRegistration, FollowsAccelerationsWithinAScan) {
  estimation::MotionState truth;
  truth.velocity = {1.0, -2.0, 0.5};
  truth.rate = {1.0, -2.0, 6.0};
  truth.acceleration = {5.0, 8.0, -3.0};
  truth.angular_acceleration = {30.0, -20.0, -15.0};
  estimation::MotionEstimate prior = arena_lo_prior(1e-3);
  prior.state = truth;
  prior.state.acceleration.setZero();
  prior.state.angular_acceleration.setZero();
  prior.covariance.diagonal().segment<6>(12) << 9.0, 9.0, 9.0, 225.0, 225.0, 225.0;
  const std::vector<Slice> slices = arena_lo_corner_scan(truth, 0.02);
  const Time end{1'100'000'000};
  const Registration found = register_slices({prior, Time{1'000'000'000}}, slices, end,
                                             arena_lo_corner_map(), Config{}, single_thread());
  for (std::size_t i = 0; i < slices.size(); ++i) {
    const Pose expected = truth.pose_after(to_seconds(slices[i].middle - Time{1'000'000'000}));
    const Pose error = expected.inverse() * found.motion[i].state.pose;
    EXPECT_LT(error.translation().norm(), 0.01) << i;
    EXPECT_LT(so3::angle(error.linear()), 0.006) << i;
  }
  const Steps guess = coast({prior, Time{1'000'000'000}}, slices, end, Config{});
  const Pose missed = truth.pose_after(0.1).inverse() * guess.back().estimate.state.pose;
  EXPECT_GT(so3::angle(missed.linear()), 0.1) << "where constant velocity would have ended";
}

}  // namespace
}  // namespace lidarena::odometry::arena_lo
