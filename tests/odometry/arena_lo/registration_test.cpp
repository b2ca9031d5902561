// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/odometry/arena_lo/registration.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "lidarena/base/random.hpp"
#include "lidarena/base/so3.hpp"
#include "tests/odometry/synthetic_room.hpp"

namespace lidarena::odometry::arena_lo {
namespace {

TEST(ArenaLoMatch, IsThePlaneThroughTheMeanAndWeighsMoreIfFlatAndNear) {
  const map::Neighborhood near{{0, 0, 2}, {0, 0, 1}, 0.5};
  const auto match = plane_match({{1, 2, 3}, 0.25F}, {0, 0, 2.3}, near, RegistrationConfig{});
  EXPECT_EQ(match.point, Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(match.alpha, 0.25);
  EXPECT_EQ(match.anchor, near.mean);
  EXPECT_EQ(match.normal, near.normal);
  EXPECT_NEAR(match.weight, 0.9 * 0.25 + 0.1 * std::exp(-0.3 / (0.3 * 10)), 1e-12);
}

Eigen::Vector3d beam_of(const CounterRandom& random, std::uint64_t i) {
  const auto n = random.normals(i, 0);
  return Eigen::Vector3d(n[0], n[1], random.normals(i, 1)[0]).normalized();
}

/// The synthetic room, seen from its middle, as a map.
const map::VoxelHashMap& room() {
  static const map::VoxelHashMap filled = [] {
    map::VoxelHashMap made({0.4, 40, 0.05});
    const CounterRandom random(3);
    for (std::uint64_t i = 0; i < 400'000; ++i) {
      const Eigen::Vector3d beam = beam_of(random, i);
      made.insert((synthetic::cast(Eigen::Vector3d::Zero(), beam) * beam).cast<float>());
    }
    return made;
  }();
  return filled;
}

std::vector<TimedPoint> seen_from(const estimation::ElasticMotion& motion, std::uint64_t count) {
  const CounterRandom random(4);
  std::vector<TimedPoint> points;
  for (std::uint64_t i = 0; i < count; ++i) {
    const double alpha = random.uniform(i, 2);
    const Pose pose = motion.at(alpha);
    const Eigen::Vector3d beam = beam_of(random, i);
    const double range = synthetic::cast(pose.translation(), pose.linear() * beam);
    points.push_back({(range * beam).cast<float>(), static_cast<float>(alpha)});
  }
  return points;
}

/// A motion that accelerates: 0, 2 and 10 degrees at its three knots.
estimation::ElasticMotion accelerating() {
  return {{Pose::Identity(), make_pose(so3::exp({0, 0, 0.035}), {0.03, 0.01, 0.0}),
           make_pose(so3::exp({0, 0, 0.17}), {0.12, 0.02, 0.02})}};
}

TEST(ArenaLoRegistration, FollowsAnAccelerationWithinTheScanThatTwoPosesCannot) {
  const estimation::ElasticMotion truth = accelerating();
  const auto keypoints = seen_from(truth, 2500);
  const auto error_with = [&](int segments) {
    const Expectation expected{estimation::ElasticMotion::still(Pose::Identity(), segments), {}};
    const Registration found =
        register_keypoints(keypoints, room(), expected, RegistrationConfig{}, Parallel(1));
    EXPECT_FALSE(found.failed);
    return so3::angle(found.motion.at(0.5).linear().transpose() * truth.at(0.5).linear());
  };
  // A quarter of the 8 - 2 degrees between a straight line and the path's middle remain at least
  // with one segment; with two, planes at edges and corners are off by centimeters over 5 m.
  EXPECT_GT(error_with(1), 0.02);
  EXPECT_LT(error_with(2), 0.004);
}

TEST(ArenaLoRegistration, IsTheSameBitsOnAnyNumberOfThreads) {
  const auto keypoints = seen_from(accelerating(), 600);
  const Expectation expected{estimation::ElasticMotion::still(Pose::Identity(), 3), {}};
  const auto with = [&](int threads) {
    return register_keypoints(keypoints, room(), expected, RegistrationConfig{}, Parallel(threads));
  };
  EXPECT_EQ(with(1).motion.end().matrix(), with(3).motion.end().matrix());
}

TEST(ArenaLoRegistration, FailsWithFewMatchesOrTooMuchRotationAndReturnsTheGuess) {
  const auto keypoints = seen_from(accelerating(), 600);
  const Expectation expected{estimation::ElasticMotion::still(Pose::Identity(), 3), {}};
  const auto with = [&](std::size_t count, double max_rotation) {
    RegistrationConfig config;
    config.lost_rotation_rad = max_rotation;
    return register_keypoints(std::span(keypoints).first(count), room(), expected, config,
                              Parallel(1));
  };
  EXPECT_FALSE(with(600, 1.2).failed);
  for (const Registration& failed : {with(0, 1.2), with(49, 1.2), with(600, 0.1)}) {
    EXPECT_TRUE(failed.failed);
    EXPECT_EQ(failed.motion.end().matrix(), expected.guess.end().matrix());
  }
}

}  // namespace
}  // namespace lidarena::odometry::arena_lo
