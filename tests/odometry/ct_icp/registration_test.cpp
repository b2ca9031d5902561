// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/odometry/ct_icp/registration.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "lidarena/base/random.hpp"
#include "lidarena/base/so3.hpp"
#include "tests/odometry/synthetic_room.hpp"

namespace lidarena::odometry::ct_icp {
namespace {

TEST(CtIcpMatch, IsThePlaneThroughTheFarthestNeighborWithThePublishedWeight) {
  // the plane z = 2, with twice the spread along x as along y
  const Eigen::Vector3f position(0.0F, 0.01F, 2.25F);
  std::vector<map::Neighbor> neighbors;
  for (int i = -2; i <= 2; ++i) {
    for (int j = -2; j <= 2; ++j) {
      const Eigen::Vector3f point(0.25F * static_cast<float>(i), 0.125F * static_cast<float>(j),
                                  2.0F);
      neighbors.push_back({point, (point - position).squaredNorm()});
    }
  }
  const auto match =
      plane_match({{1, 2, 3}, 0.25F}, position.cast<double>(), neighbors, RegistrationConfig{});
  EXPECT_EQ(match.point, Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(match.alpha, 0.25);
  EXPECT_NEAR(std::abs(match.normal.z()), 1.0, 1e-6);
  EXPECT_EQ(std::abs(match.anchor.x()), 0.5);
  EXPECT_EQ(match.anchor.y(), -0.25);
  const double distance = (match.anchor - position.cast<double>()).norm();
  // planarity 1/2 from deviations 2 : 1 : 0, known to a float's square root; 0.3 m times 20
  EXPECT_NEAR(match.weight, 0.9 * 0.25 + 0.1 * std::exp(-distance / 6.0), 1e-3);
}

/// The inside of the synthetic room from its middle, as a map.
const map::VoxelHashMap& room() {
  static const map::VoxelHashMap filled = [] {
    map::VoxelHashMap made({0.8, 30, 0.08});
    const CounterRandom random(3);
    for (std::uint64_t i = 0; i < 200'000; ++i) {
      const auto n = random.normals(i, 0);
      const Eigen::Vector3d beam =
          Eigen::Vector3d(n[0], n[1], random.normals(i, 1)[0]).normalized();
      const Eigen::Vector3d point = synthetic::cast(Eigen::Vector3d::Zero(), beam) * beam;
      made.insert(point.cast<float>());
    }
    return made;
  }();
  return filled;
}

/// What a lidar with this motion sees of the room's outer walls and pillars.
std::vector<TimedPoint> seen_from(const ElasticMotion& motion, std::uint64_t count) {
  const CounterRandom random(4);
  std::vector<TimedPoint> points;
  for (std::uint64_t i = 0; i < count; ++i) {
    const double alpha = random.uniform(i, 2);
    const Pose pose = motion.at(alpha);
    const auto n = random.normals(i, 0);
    const Eigen::Vector3d beam = Eigen::Vector3d(n[0], n[1], random.normals(i, 1)[0]).normalized();
    const double range = synthetic::cast(pose.translation(), pose.linear() * beam);
    points.push_back({(range * beam).cast<float>(), static_cast<float>(alpha)});
  }
  return points;
}

TEST(CtIcpRegistration, FindsTheMotionOfAScanThatMovesAndTurns) {
  const ElasticMotion truth{make_pose(so3::exp({0, 0, 0.02}), {0.05, 0.02, 0.0}),
                            make_pose(so3::exp({0.02, 0, 0.1}), {0.15, 0.05, 0.03})};
  const auto keypoints = seen_from(truth, 800);
  const Expectation expected{ElasticMotion::still(Pose::Identity()), {}};
  RegistrationConfig config;
  config.max_iterations = 30;
  const Registration one = register_keypoints(keypoints, room(), expected, config, Parallel(1));
  EXPECT_FALSE(one.failed);
  EXPECT_GT(one.matches, 700U);
  EXPECT_GT(one.observability, 0.1);
  // planes of 20 neighbors at edges and pillars are off by some centimeters; 800 points, and a
  // registration that ends at steps of 1 cm
  EXPECT_LT((one.motion.begin.translation() - truth.begin.translation()).norm(), 0.02);
  EXPECT_LT((one.motion.end.translation() - truth.end.translation()).norm(), 0.02);
  EXPECT_LT(so3::angle(one.motion.end.linear().transpose() * truth.end.linear()), 0.005);

  const Registration three = register_keypoints(keypoints, room(), expected, config, Parallel(3));
  EXPECT_EQ(one.motion.end.matrix(), three.motion.end.matrix()) << "any number of threads";
}

TEST(CtIcpRegistration, FailsWithFewerMatchesThanNeighborsOfAPoint) {
  const auto still = ElasticMotion::still(Pose::Identity());
  const Expectation expected{still, {}};
  const auto keypoints = seen_from(still, 60);
  for (const std::size_t count : {0U, 19U, 60U}) {
    const Registration found = register_keypoints(std::span(keypoints).first(count), room(),
                                                  expected, RegistrationConfig{}, Parallel(1));
    EXPECT_EQ(found.failed, count < 20) << count;
    if (found.failed) {
      EXPECT_EQ(found.motion.end.matrix(), still.end.matrix());
    }
  }
}

}  // namespace
}  // namespace lidarena::odometry::ct_icp
