// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/loop/icp.hpp"

#include <gtest/gtest.h>

#include "tests/loop/places.hpp"

namespace lidarena::loop {
namespace {

struct Pair {
  Pose truth = Pose::Identity();
  map::KdTree target;
  places::Points source;
};

/// The corridor's corner, seen from two places.
Pair corner() {
  const places::Points world = places::ring_corridor();
  const Pose first = places::standing(-10.0, -10.0, 0.2);
  const Pose second = places::standing(-9.4, -9.8, 0.5);
  Pair pair;
  pair.truth = first.inverse() * second;
  pair.target.build(places::seen_from(first, world, 10.0, 1));
  pair.source = places::seen_from(second, world, 8.0, 2);
  return pair;
}

double apart(const Pose& a, const Pose& b) { return (a.translation() - b.translation()).norm(); }

TEST(Icp, LaysPlanesOnPlanes) {
  const Pair pair = corner();
  const Pose guess = pair.truth * make_pose(so3::exp({0.01, -0.02, 0.1}), {0.3, -0.3, 0.1});
  const IcpResult result = align_clouds(pair.source, pair.target, guess, Parallel(1));
  EXPECT_TRUE(result.converged);
  // Noise of 1 cm per point, over about a thousand points on each wall, gives far below 1 mm. But
  // both clouds are the same points with different noise, of which a plane through 6 points still
  // has 1/sqrt(6).
  EXPECT_LT(apart(result.target_from_source, pair.truth), 2e-3);
  EXPECT_LT(so3::angle(pair.truth.linear().transpose() * result.target_from_source.linear()), 1e-3);
  EXPECT_GT(result.overlap, 0.99);
  // squared distance between two noisy copies of a point: 6 * (1 cm)^2 at most
  EXPECT_LT(result.fitness, 6e-4);
  EXPECT_GT(result.constraint, 0.01);
}

TEST(Icp, LaysPointsOnPoints) {
  const Pair pair = corner();
  const Pose guess = pair.truth * make_pose(so3::exp({0.0, 0.0, 0.05}), {0.1, -0.1, 0.05});
  const PointAlignment found = align_points(pair.source, pair.target, guess, 30.0, Parallel(1));
  EXPECT_TRUE(found.converged);
  EXPECT_LT(apart(found.target_from_source, pair.truth), 2e-2);
  EXPECT_LT(found.fitness, 0.01);
  const PointAlignment far =
      align_points(pair.source, pair.target, places::standing(500.0, 0.0, 0.0), 30.0, Parallel(1));
  EXPECT_FALSE(far.converged) << "nothing within 30 m";
}

TEST(Icp, AFarCloudHasNothingToHold) {
  const Pair pair = corner();
  const IcpResult result =
      align_clouds(pair.source, pair.target, places::standing(500.0, 0.0, 0.0), Parallel(1));
  EXPECT_FALSE(result.converged);
  EXPECT_EQ(result.overlap, 0.0);
}

TEST(Icp, AlongAStraightTunnelTheConstraintIsWeak) {
  places::Points walls;
  for (int i = 0; i < 200; ++i) {
    for (int k = 0; k < 12; ++k) {
      const float x = 0.2F * static_cast<float>(i) - 20.0F;
      const float h = 0.25F * static_cast<float>(k);
      walls.insert(walls.end(),
                   {{x, 2.0F, h}, {x, -2.0F, h}, {x, h - 1.5F, 0.0F}, {x, h - 1.5F, 3.0F}});
    }
  }
  map::KdTree target;
  target.build(walls);
  const places::Points source = places::seen_from(Pose::Identity(), walls, 8.0, 3);
  const IcpResult result = align_clouds(source, target, Pose::Identity(), Parallel(1));
  EXPECT_LT(result.constraint, 0.005) << "the minimum for a loop";
}

}  // namespace
}  // namespace lidarena::loop
