// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/evaluation/trajectory/hover_jitter.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "flights.hpp"

namespace lidarena::evaluation {
namespace {

using namespace std::chrono_literals;
using Eigen::Vector3d;
using flights::level;
using flights::sample;

/// 0..5 s and 15..20 s at rest, between them 1 m/s.
Pose two_hovers(double t) { return level({std::clamp(t - 5.0, 0.0, 10.0), 0, 2}); }

HoverJitter jitter_of(const Trajectory& estimate, const Trajectory& truth) {
  return hover_jitter(matched_poses(estimate, truth), gap_limit_of(estimate));
}

TEST(HoverJitter, IsTheNoiseOfTheHoversWhateverTheFlightBetweenAndTheFrame) {
  SequentialRandom random(51);
  const double sigma = 0.02;
  const Pose elsewhere = flights::random_pose(random, 5.0);
  const Trajectory truth = sample(two_hovers, 10ms, 20s);
  const Trajectory estimate =
      flights::mapped(sample(two_hovers, 100ms, 20s), [&](const StampedPose& pose) {
        const Vector3d noise(random.normal(), random.normal(), random.normal());
        const double meters = pose.world_from_body.translation().x();
        const Vector3d drift(0, 0.1 * meters, 0);  // 1 m over the flight, none at rest
        return elsewhere * level(drift + sigma * noise) * pose.world_from_body;
      });
  const HoverJitter jitter = jitter_of(estimate, truth);
  EXPECT_EQ(jitter.poses, 2U * 51U);
  EXPECT_NEAR(jitter.seconds, 10.0, 1e-9);
  // 3 axes, each with a mean over 51 values; 300 degrees of freedom: relative error 1 / sqrt(600),
  // tolerance four times that
  const double expected = sigma * std::sqrt(3.0 * 50.0 / 51.0);
  EXPECT_NEAR(jitter.rms_m, expected, 4.0 * expected / std::sqrt(600.0));
}

TEST(HoverJitter, OfAFlightThatNeverStopsOrStopsBrieflyIsNone) {
  const Trajectory moving = sample([](double t) { return level({t, 0, 0}); }, 100ms, 10s);
  EXPECT_EQ(jitter_of(moving, moving).poses, 0U);
  const Trajectory brief = sample(
      [](double t) {
        return level({std::max(0.0, t - 0.8), 0, 0});
      },
      100ms, 10s);
  EXPECT_EQ(jitter_of(brief, brief).poses, 0U);
  EXPECT_EQ(hover_jitter({}, 150ms).rms_m, 0.0);
}

TEST(HoverJitter, AJumpAcrossATrackingLossIsNotJitter) {
  const Trajectory truth = sample([](double) { return level({0, 0, 2}); }, 10ms, 10s);
  const Trajectory estimate = flights::mapped(
      flights::with_gap(sample([](double) { return Pose::Identity(); }, 100ms, 10s), 4s, 6s),
      [](const StampedPose& pose) {
        return level({pose.stamp > 5s ? 1.0 : 0.0, 0, 0});
      });
  EXPECT_NEAR(jitter_of(estimate, truth).seconds, 8.0, 1e-9);
  EXPECT_LT(jitter_of(estimate, truth).rms_m, 1e-12);
}

}  // namespace
}  // namespace lidarena::evaluation
