// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/evaluation/trajectory/alignment.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <numbers>

#include "flights.hpp"

namespace lidarena::evaluation {
namespace {

using namespace std::chrono_literals;
using Eigen::Vector3d;
using flights::level;
using flights::sample;
using flights::tour;
using ::testing::HasSubstr;

/// Largest difference between the entries of two transforms.
double difference(const Pose& a, const Pose& b) {
  return (a.matrix() - b.matrix()).cwiseAbs().maxCoeff();
}

Trajectory moved(const Trajectory& trajectory, const Pose& a_from_b) {
  return flights::mapped(trajectory,
                         [&](const StampedPose& pose) { return a_from_b * pose.world_from_body; });
}

TEST(Umeyama, FindsARandomTransformToRounding) {
  SequentialRandom random(1);
  const Trajectory estimate = sample(tour, 100ms, 20s);
  for (int trial = 0; trial < 50; ++trial) {
    const Pose truth_from_estimate = flights::random_pose(random, 5.0);
    const Trajectory truth = moved(estimate, truth_from_estimate);
    const Alignment found = align(estimate, truth, AlignmentKind::kSe3);
    ASSERT_TRUE(found.determined());
    EXPECT_LT(difference(found.truth_from_estimate, truth_from_estimate), 1e-12);
    EXPECT_NEAR(found.scale_hint, 1.0, 1e-12);
  }
}

TEST(Umeyama, AgreesWithEigenOnNoisyAndMirroredPositions) {
  SequentialRandom random(2);
  for (int trial = 0; trial < 50; ++trial) {
    std::vector<PosePair> pairs(40);
    Eigen::Matrix3Xd p(3, 40);
    Eigen::Matrix3Xd q(3, 40);
    const Pose truth_from_estimate = flights::random_pose(random, 3.0);
    const double mirror = trial % 5 == 0 ? -1.0 : 1.0;  // gives det(U) det(V) < 0
    for (int i = 0; i < 40; ++i) {
      p.col(i) = Vector3d(random.normal(), random.normal(), random.normal());
      const Vector3d noise(random.normal(), random.normal(), random.normal());
      const Vector3d image(p(0, i), p(1, i), mirror * p(2, i));
      q.col(i) = truth_from_estimate * Vector3d(1.7 * image) + 0.1 * noise;
      pairs[static_cast<std::size_t>(i)] = {Time{i}, level(q.col(i)), level(p.col(i))};
    }
    for (const bool with_scale : {false, true}) {
      const Similarity fit = umeyama(pairs, with_scale);
      Eigen::Matrix4d found = Eigen::Matrix4d::Identity();
      found.topLeftCorner<3, 3>() = fit.scale * fit.rotation;
      found.topRightCorner<3, 1>() = fit.translation;
      EXPECT_LT((found - Eigen::umeyama(p, q, with_scale)).cwiseAbs().maxCoeff(), 1e-12);
    }
  }
}

TEST(FirstPoseAlignment, LaysTheFirstCommonPosesOnEachOtherAndFitsNothing) {
  SequentialRandom random(3);
  const Pose truth_from_estimate = flights::random_pose(random, 5.0);
  const Trajectory truth = sample(tour, 10ms, 20s);
  const Trajectory estimate = flights::mapped(
      flights::with_gap(sample(tour, 100ms, 20s), -1s, 3s), [&](const StampedPose& pose) {
        // drifts after the first pose, so that any fit would give another transform
        const double drift = 0.1 * (to_seconds(pose.stamp) - 3.0);
        return truth_from_estimate.inverse() * level({drift, 0, 0}) * pose.world_from_body;
      });
  const Alignment found = align(estimate, truth, AlignmentKind::kFirstPose);
  EXPECT_LT(difference(found.truth_from_estimate, truth_from_estimate), 1e-12);
}

TEST(PosYawAlignment, FindsHeadingAndPositionOfAnUprightEstimate) {
  const Pose truth_from_estimate = make_pose(so3::exp({0, 0, -2.5}), Vector3d(3, -2, 1));
  const Trajectory estimate = sample(tour, 100ms, 20s);
  const Alignment found =
      align(estimate, moved(estimate, truth_from_estimate), AlignmentKind::kPosYaw);
  EXPECT_LT(difference(found.truth_from_estimate, truth_from_estimate), 1e-12);
  EXPECT_TRUE(found.warning.empty());
}

TEST(PosYawAlignment, WarnsWhenTheEstimateLeans) {
  const Pose leaning = make_pose(so3::exp({0.2, 0, 0}), Vector3d::Zero());
  const Trajectory estimate = sample(tour, 100ms, 20s);
  const Alignment found = align(estimate, moved(estimate, leaning), AlignmentKind::kPosYaw);
  EXPECT_TRUE(found.determined());
  EXPECT_THAT(found.warning, HasSubstr("tilted by 11.5 deg"));  // 0.2 rad
  EXPECT_NEAR(found.tilt_rad, 0.2, 1e-12);
}

TEST(Se3Alignment, RefusesALineBecauseTheRollAboutItIsArbitrary) {
  const auto line = sample([](double t) { return level({t, 2.0 * t, 0.5 * t}); }, 100ms, 10s);
  const Alignment found = align(line, line, AlignmentKind::kSe3);
  EXPECT_THAT(found.refusal, HasSubstr("line"));
  EXPECT_TRUE(align(line, line, AlignmentKind::kFirstPose).determined());
  EXPECT_TRUE(align(line, line, AlignmentKind::kPosYaw).determined());
}

TEST(Se3Alignment, RefusesANearLineButTakesAFlatFlight) {
  const auto near_line = sample(
      [](double t) {
        return level({t, 1e-3 * std::sin(t), 1e-3 * std::cos(t)});
      },
      100ms, 10s);
  EXPECT_FALSE(align(near_line, near_line, AlignmentKind::kSe3).determined());
  const auto flat = sample([](double t) { return level({t, std::sin(t), 1.5}); }, 100ms, 10s);
  const Alignment found = align(flat, flat, AlignmentKind::kSe3);
  ASSERT_TRUE(found.determined()) << found.refusal;
  EXPECT_LT(difference(found.truth_from_estimate, Pose::Identity()), 1e-12);
}

TEST(Alignment, HoverFewPosesAndNoOverlapAreRefusedInWords) {
  const auto hover = sample([](double) { return level({1, 2, 3}); }, 100ms, 10s);
  EXPECT_THAT(align(hover, hover, AlignmentKind::kSe3).refusal, HasSubstr("spread"));
  EXPECT_THAT(align(hover, hover, AlignmentKind::kPosYaw).refusal, HasSubstr("spread"));
  EXPECT_TRUE(align(hover, hover, AlignmentKind::kFirstPose).determined());
  const auto two = sample(tour, 100ms, 100ms);
  EXPECT_THAT(align(two, two, AlignmentKind::kSe3).refusal, HasSubstr("only 2 common poses"));
  EXPECT_THAT(align(two, flights::shifted(two, 5s), AlignmentKind::kFirstPose).refusal,
              HasSubstr("no estimate lies inside"));
  const auto climb = sample([](double t) { return level({0, 0, t}); }, 100ms, 10s);
  EXPECT_THAT(align(climb, climb, AlignmentKind::kPosYaw).refusal, HasSubstr("heading"));
}

}  // namespace
}  // namespace lidarena::evaluation
