// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/loop/loop_closer.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "lidarena/base/se3.hpp"
#include "tests/loop/places.hpp"

namespace lidarena::loop {
namespace {

using places::Points;

/// A path of keyframes one second apart: the truth, and odometry with a constant error per step.
struct Walk {
  std::vector<Pose> truth;
  std::vector<Points> clouds;
  std::vector<Pose> steps;  ///< measured
};

Walk walk(const std::vector<Pose>& truth, const Points& world, double reach,
          const se3::Vector6& error_per_step) {
  Walk walk;
  walk.truth = truth;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    walk.clouds.push_back(places::seen_from(truth[i], world, reach, i));
    walk.steps.push_back(i == 0 ? truth[0]
                                : truth[i - 1].inverse() * truth[i] * se3::exp(error_per_step));
  }
  return walk;
}

/// 1.3 times around the block; the odometry is 1 % too long and rotates 0.06 degrees per meter too
/// far.
Walk round_trip() {
  std::vector<Pose> truth;
  for (int i = 0; i <= 104; ++i) truth.push_back(places::around_the_block(i));
  se3::Vector6 error;
  error << 0.01, 0.0, 0.0, 0.0, 0.0, 0.001;
  return walk(truth, places::ring_corridor(), 9.0, error);
}

LoopCloser closed(const Walk& walk, const LoopConfig& config, int threads = 1) {
  LoopCloser closer(config, Parallel(threads));
  const KeyframeCloud cloud = [&](std::size_t i) {
    return std::span<const Eigen::Vector3f>(walk.clouds[i]);
  };
  for (std::size_t i = 0; i < walk.steps.size(); ++i)
    closer.add(from_seconds(static_cast<double>(i)), walk.steps[i], cloud);
  return closer;
}

double rms_error(const Walk& walk, const std::vector<Pose>& poses) {
  double sum = 0.0;
  for (std::size_t i = 0; i < poses.size(); ++i)
    sum += (poses[i].translation() - walk.truth[i].translation()).squaredNorm();
  return std::sqrt(sum / static_cast<double>(poses.size()));
}

LoopConfig no_loops() {
  LoopConfig config;
  config.search_radius_m = 0.0;
  config.descriptor_candidates = 0;
  return config;
}

TEST(LoopCloser, ComingBackCuresTheDrift) {
  const Walk trip = round_trip();
  const double drifted = rms_error(trip, closed(trip, no_loops()).poses());
  const LoopCloser closer = closed(trip, LoopConfig{});
  EXPECT_GT(drifted, 0.6);
  EXPECT_GT(closer.accepted(), 0U);
  EXPECT_LT(rms_error(trip, closer.poses()), 0.4 * drifted)
      << "not lower: the error is distributed evenly, unlike the true one";
  for (const LoopRecord& loop : closer.records()) {
    if (loop.verdict != LoopVerdict::kAccepted) continue;
    const Pose truth = trip.truth[loop.first].inverse() * trip.truth[loop.second];
    // the odometry also adds errors to the target: over 8 keyframes on each side, 1 cm each
    EXPECT_LT((truth.inverse() * loop.first_from_second).translation().norm(), 0.08);
  }
}

TEST(LoopCloser, IsFoundByLooksAloneToo) {
  LoopConfig config;
  config.search_radius_m = 0.0;
  config.descriptor_range_m = 9.0;
  const Walk trip = round_trip();
  const LoopCloser closer = closed(trip, config);
  EXPECT_GT(closer.accepted(), 0U);
  for (const LoopRecord& loop : closer.records()) EXPECT_TRUE(loop.by_appearance);
}

/// Through a room, a passage, and an identical second room, three times as long in each as
/// necessary.
Walk identical_rooms() {
  Points world;
  places::add_room(world, 0.0F);
  places::add_room(world, 12.0F);
  places::add_box(world, {4, -1, 0}, {8, 1, 3}, true);
  std::vector<Pose> truth;
  const auto circle = [&](double x) {
    for (int i = 0; i < 60; ++i) {
      const double angle = 0.3 * i;
      truth.push_back(places::standing(x + 1.5 * std::cos(angle), 1.2 * std::sin(angle), angle));
    }
  };
  circle(0.0);
  for (int i = 0; i <= 18; ++i) truth.push_back(places::standing(1.5 + 0.5 * i, 0.0, 0.0));
  circle(12.0);
  se3::Vector6 error;
  error << 0.001, 0.0, 0.0, 0.0, 0.0, 0.0002;
  return walk(truth, world, 5.0, error);
}

TEST(LoopCloser, OfTwoIdenticalRoomsTheSecondIsNotTheFirst) {
  const Walk tour = identical_rooms();
  LoopConfig config;
  config.descriptor_range_m = 5.0;
  config.search_radius_m = 15.0;
  const LoopCloser closer = closed(tour, config);
  int refused = 0;
  for (const LoopRecord& loop : closer.records()) {
    const Pose truth = tour.truth[loop.first].inverse() * tour.truth[loop.second];
    const double wrong = (truth.inverse() * loop.first_from_second).translation().norm();
    if (loop.verdict == LoopVerdict::kAccepted) {
      EXPECT_LT(wrong, 0.1) << loop.first << " " << loop.second;
    }
    if (wrong > 10.0 && loop.verdict == LoopVerdict::kBeyondDrift) ++refused;
  }
  EXPECT_GT(refused, 0) << "the rooms match each other: only the limit on drift can reject that";
  EXPECT_GT(closer.accepted(), 0U) << "correct ones, within each room";
  EXPECT_LT(rms_error(tour, closer.poses()), 0.1);

  // With drift that may be meters, false loops are accepted; then only the graph's robust kernel
  // limits the damage.
  config.translation_drift_m_per_m = 0.2;
  config.rotation_drift_rad_per_m = 0.02;
  const LoopCloser trusting = closed(tour, config);
  int false_loops = 0;
  for (const LoopRecord& loop : trusting.records())
    false_loops += loop.verdict == LoopVerdict::kAccepted && loop.translation_m > 10.0 ? 1 : 0;
  EXPECT_GT(false_loops, 0);
  EXPECT_LT(rms_error(tour, trusting.poses()), 0.5);
}

/// An exact walk, but for the clouds of five keyframes, which are `beside` (m) their place.
Walk walk_with_wrong_clouds(float beside) {
  std::vector<Pose> truth;
  for (int i = 0; i <= 104; ++i) truth.push_back(places::around_the_block(i));
  Walk walk = loop::walk(truth, places::ring_corridor(), 9.0, se3::Vector6::Zero());
  for (std::size_t i = 90; i < 95; ++i)
    for (Eigen::Vector3f& p : walk.clouds[i]) p.x() += beside;
  return walk;
}

TEST(LoopCloser, OneWrongLoopDoesNotMoveAPathThatDriftsLess) {
  LoopConfig config;
  config.translation_drift_m_per_m = 2e-3;
  config.rotation_drift_rad_per_m = 2e-4;
  // The first is far beyond what a loop may be wrong; the second agrees with the others barely.
  for (const float beside : {0.08F, 0.035F}) {
    const Walk trip = walk_with_wrong_clouds(beside);
    const LoopCloser closer = closed(trip, config);
    EXPECT_TRUE(std::ranges::any_of(closer.records(), &LoopRecord::corrects))
        << "the clouds do contradict the path";
    EXPECT_GT(closer.accepted(), 0U);
    EXPECT_LT(rms_error(trip, closer.poses()), 1e-6) << beside;
  }
}

TEST(LoopCloser, StandingStillNoLoopIsTried) {
  const Points world = places::ring_corridor();
  const std::vector<Pose> truth(60, places::around_the_block(10.0));
  const Walk still = walk(truth, world, 9.0, se3::Vector6::Zero());
  EXPECT_TRUE(closed(still, LoopConfig{}).records().empty());
  LoopConfig without_minimum;
  without_minimum.min_path_length_m = 0.0;
  EXPECT_FALSE(closed(still, without_minimum).records().empty());
}

TEST(LoopCloser, IsTheSameBitsOnAnyNumberOfThreads) {
  const Walk trip = round_trip();
  const auto one = closed(trip, LoopConfig{}, 1).poses();
  const auto three = closed(trip, LoopConfig{}, 3).poses();
  for (std::size_t i = 0; i < one.size(); ++i) EXPECT_EQ(one[i].matrix(), three[i].matrix());
}

TEST(LoopCloser, AFewPointsAreNoPlace) {
  Walk trip = round_trip();
  for (Points& cloud : trip.clouds) cloud.resize(20);
  const LoopCloser closer = closed(trip, LoopConfig{});
  EXPECT_EQ(closer.accepted(), 0U);
  EXPECT_TRUE(std::any_of(closer.records().begin(), closer.records().end(), [](const auto& loop) {
    return loop.verdict == LoopVerdict::kTooFewPoints;
  }));
}

}  // namespace
}  // namespace lidarena::loop
