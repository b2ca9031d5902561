// SPDX-License-Identifier: BSD-3-Clause
// Tests that every odometry of the factory must pass with each of its presets. Instantiated from
// the factory's list, so a new algorithm is tested as soon as it is listed.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "lidarena/base/so3.hpp"
#include "lidarena/odometry/factory.hpp"
#include "tests/odometry/synthetic_room.hpp"

namespace lidarena::odometry {
namespace {

using synthetic::Recording;

struct Candidate {
  std::string algorithm;
  std::string preset;
};

std::vector<Candidate> candidates() {
  std::vector<Candidate> all;
  for (const AlgorithmInfo& info : list_algorithms()) {
    for (const std::string& preset : info.presets) all.push_back({info.name, preset});
    if (info.presets.empty()) all.push_back({info.name, ""});
  }
  return all;
}

const std::vector<dataset::Event>& usual_events() {
  static const std::vector<dataset::Event> events = synthetic::record({});
  return events;
}

struct Outcome {
  std::vector<ScanResult> results;
  Trajectory trajectory;
};

/// Feeds one event; appends the result of a scan.
void feed(Odometry& odometry, const dataset::Event& event, std::vector<ScanResult>& results) {
  if (const auto* scan = std::get_if<Scan>(&event.data)) {
    results.push_back(odometry.register_scan(*scan));
  } else {
    odometry.register_imu(std::get<ImuSample>(event.data));
  }
}

class OdometryConformance : public testing::TestWithParam<Candidate> {
 protected:
  static std::unique_ptr<Odometry> make(const Recording& recording = {}, int threads = 1) {
    const auto& [algorithm, preset] = GetParam();
    return make_odometry({algorithm, preset, "", {}}, synthetic::rig_of(recording), "lidar",
                         Parallel(threads))
        .odometry;
  }
  static Outcome play(Odometry& odometry, const std::vector<dataset::Event>& events) {
    Outcome outcome;
    for (const dataset::Event& event : events) feed(odometry, event, outcome.results);
    odometry.finish();
    outcome.trajectory = odometry.trajectory();
    return outcome;
  }
  static Outcome play(const Recording& recording) {
    const auto odometry = make(recording);
    return play(*odometry, synthetic::record(recording));
  }
};

void expect_same(const Trajectory& a, const Trajectory& b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(a.poses()[i].stamp, b.poses()[i].stamp);
    EXPECT_EQ(a.poses()[i].world_from_body.matrix(), b.poses()[i].world_from_body.matrix());
  }
}

/// Largest distance (m) from the true flight, both relative to the last pose before the start of
/// motion: relative motions do not depend on the world frame, which a gravity-aligned method
/// levels.
double largest_error(const Recording& recording, const Trajectory& estimate) {
  const std::size_t first = estimate.upper_bound(recording.epoch + from_seconds(0.9)) - 1;
  const StampedPose& start = estimate.poses()[first];
  double largest = 0.0;
  for (const StampedPose& pose : estimate.poses().subspan(first)) {
    const Pose moved = start.world_from_body.inverse() * pose.world_from_body;
    const Pose true_moved = synthetic::truth(recording, start.stamp, pose.stamp);
    largest = std::max(largest, (moved.translation() - true_moved.translation()).norm());
  }
  return largest;
}

// A quarter of the 1 m voxels of the coarsest preset's map. After tracking is lost, errors are
// meters: the flight moves 2.3 m away and turns by 45 degrees.
constexpr double kTracked = 0.25;

TEST_P(OdometryConformance, PosesAreFiniteInOrderOfTimeAndFollowTheFlight) {
  const auto odometry = make();
  const Outcome outcome = play(*odometry, usual_events());
  ASSERT_EQ(outcome.results.size(), 40U);
  Time previous{0};
  for (const ScanResult& result : outcome.results) {
    EXPECT_GT(result.estimate.stamp, previous);
    EXPECT_TRUE(result.estimate.world_from_body.matrix().allFinite());
    for (std::size_t i = 1; i < result.motion.size(); ++i)
      EXPECT_GT(result.motion[i].stamp, result.motion[i - 1].stamp);
    previous = result.estimate.stamp;
  }
  EXPECT_EQ(outcome.results.back().status, ScanStatus::kTracked);
  EXPECT_LT(largest_error({}, outcome.trajectory), kTracked);
}

TEST_P(OdometryConformance, TwoInstancesInterleavedDoAsEachAlone) {
  const Recording other{.range_noise_m = 0.02, .epoch = Time{77}};
  const std::vector<dataset::Event> other_events = synthetic::record(other);
  const Outcome alone = play(*make(), usual_events());
  const Outcome other_alone = play(*make(other), other_events);

  const auto a = make();
  const auto b = make(other);
  std::vector<ScanResult> ignored;
  for (std::size_t i = 0; i < std::max(usual_events().size(), other_events.size()); ++i) {
    if (i < usual_events().size()) feed(*a, usual_events()[i], ignored);
    if (i < other_events.size()) feed(*b, other_events[i], ignored);
  }
  a->finish();
  b->finish();
  expect_same(a->trajectory(), alone.trajectory);
  expect_same(b->trajectory(), other_alone.trajectory);
}

TEST_P(OdometryConformance, IsTheSameBitsOnOneAndThreeThreads) {
  expect_same(play(*make({}, 1), usual_events()).trajectory,
              play(*make({}, 3), usual_events()).trajectory);
}

TEST_P(OdometryConformance, EmptyScansAndPointsThatAreNotFiniteAreSurvivedAndTold) {
  std::vector<dataset::Event> events = usual_events();
  std::size_t index = 0;
  for (dataset::Event& event : events) {
    auto* scan = std::get_if<Scan>(&event.data);
    if (scan == nullptr) continue;
    const std::size_t every = index == 12 ? 10 : index == 20 ? 1 : 0;
    for (std::size_t i = 0; every > 0 && i < scan->points.size(); i += every)
      scan->points[i].position.y() = std::numeric_limits<float>::quiet_NaN();
    if (index == 16) scan->points.clear();
    ++index;
  }
  const Outcome outcome = play(*make(), events);
  ASSERT_EQ(outcome.results.size(), 40U);
  EXPECT_EQ(outcome.results[12].status, ScanStatus::kTracked) << "9 of 10 points are good";
  EXPECT_EQ(outcome.results[16].status, ScanStatus::kTooFewPoints) << "no points";
  EXPECT_EQ(outcome.results[20].status, ScanStatus::kTooFewPoints) << "no good points";
  EXPECT_EQ(outcome.results.back().status, ScanStatus::kTracked);
  for (std::size_t i = 1; i < outcome.results.size(); ++i)
    EXPECT_GT(outcome.results[i].estimate.stamp, outcome.results[i - 1].estimate.stamp);
  EXPECT_LT(largest_error({}, outcome.trajectory), kTracked);
}

TEST_P(OdometryConformance, AFirstScanWithoutPointsIsSurvived) {
  std::vector<dataset::Event> events = usual_events();
  for (dataset::Event& event : events) {
    auto* scan = std::get_if<Scan>(&event.data);
    if (scan == nullptr) continue;
    scan->points.clear();
    break;
  }
  const Outcome outcome = play(*make(), events);
  EXPECT_EQ(outcome.results.front().status, ScanStatus::kTooFewPoints);
  EXPECT_EQ(outcome.results.back().status, ScanStatus::kTracked);
  EXPECT_LT(largest_error({}, outcome.trajectory), kTracked);
}

TEST_P(OdometryConformance, WhereAndHowTheFlightStartsDoesNotMatter) {
  const Pose elsewhere = make_pose(so3::exp({0, 0, 2.0}), {1.0, -1.5, 0.2});
  const Recording moved{.motion = [&](double t) { return elsewhere * synthetic::flight(t); }};
  EXPECT_LT(largest_error(moved, play(moved).trajectory), kTracked);
}

TEST_P(OdometryConformance, WhenTheFlightTakesPlaceDoesNotMatter) {
  const Recording today{.seconds = 2.5, .epoch = Time{1'760'000'000'123'456'789}};
  const Recording then{.seconds = 2.5};
  const Trajectory a = play(today).trajectory;
  const Trajectory b = play(then).trajectory;
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(a.poses()[i].stamp - today.epoch, b.poses()[i].stamp - then.epoch);
    EXPECT_LT(
        (a.poses()[i].world_from_body.matrix() - b.poses()[i].world_from_body.matrix()).norm(),
        1e-9);
  }
}

// The beams of the next two tests do not repeat, and are denser: of those that do, the points of a
// wall lie on a few lines, through which any plane fits, and a published method may be held at its
// pose by them.
constexpr std::size_t kDense = 64 * 512;

TEST_P(OdometryConformance, HowTheSensorIsMountedDoesNotMatter) {
  const Recording mounted{.body_from_lidar = make_pose(so3::exp({0.1, 0.3, 1.2}), {0.2, -0.1, 0.3}),
                          .points_per_scan = kDense,
                          .repeating = false};
  EXPECT_LT(largest_error(mounted, play(mounted).trajectory), kTracked);
}

TEST_P(OdometryConformance, StandingStillItStaysPut) {
  // Of the presets for rooms the coarsest matches about 300 points with a map whose points are 0.5
  // m apart: up to 0.25 m each, 0.25 m / sqrt(300) = 1.5 cm together. The presets for cars match
  // some 80 points with planes through points up to 0.5 m away: 0.5 m / sqrt(80) = 5.6 cm. The
  // limit is twice that.
  const double limit = GetParam().preset == "published" ? 0.11 : 0.03;
  const Recording still{.motion = [](double) { return synthetic::flight(0.0); }};
  const Outcome outcome = play(still);
  const Pose& first = outcome.trajectory.poses().front().world_from_body;
  for (const StampedPose& pose : outcome.trajectory.poses()) {
    const Pose moved = first.inverse() * pose.world_from_body;
    EXPECT_LT(moved.translation().norm(), limit);
    EXPECT_LT(so3::angle(moved.linear()), limit / 5.0) << "at a distance of 5 m";
  }
}

TEST_P(OdometryConformance, MemoryIsNamedAndTheMapHasSome) {
  const auto odometry = make();
  play(*odometry, usual_events());
  const auto memory = odometry->memory();
  for (const auto& [name, bytes] : memory) {
    EXPECT_THAT(name, testing::AnyOf("map", "scan_buffer", "backlog", "other"));
    EXPECT_LT(bytes, 1U << 30U) << name;
  }
  ASSERT_TRUE(memory.contains("map"));
  EXPECT_GE(memory.at("map"), odometry->map().size() * sizeof(float));
  EXPECT_GT(odometry->map().size(), 100U);
}

TEST_P(OdometryConformance, WhatItPublishesLiesOnTheWalls) {
  const auto odometry = make();
  const Outcome outcome =
      play(*odometry, synthetic::record({.points_per_scan = kDense, .repeating = false}));
  const bool by_scan = odometry->traits().publishes_scans;
  std::vector<Eigen::Vector3f> points = odometry->map();
  if (by_scan)
    points.assign(odometry->registered_scan().begin(), odometry->registered_scan().end());
  ASSERT_GT(points.size(), 100U);
  const StampedPose& last = outcome.trajectory.poses().back();
  const Pose room_from_world = synthetic::flight(to_seconds(last.stamp - Recording{}.epoch)) *
                               last.world_from_body.inverse();
  std::size_t near = 0;
  for (const Eigen::Vector3f& point : points) {
    const Eigen::Vector3d p = room_from_world * point.cast<double>();
    const Eigen::Vector3d viewpoint = synthetic::flight(3.0).translation();
    const double range = (p - viewpoint).norm();
    const double gap = range - synthetic::cast(viewpoint, (p - viewpoint) / range);
    near += std::abs(gap) < kTracked ? 1U : 0U;
  }
  EXPECT_GT(static_cast<double>(near), 0.9 * static_cast<double>(points.size()))
      << "pillars may hide a few points from this viewpoint";
}

TEST_P(OdometryConformance, FinishingTwiceIsFinishingOnceAndNothingGivesNothing) {
  const auto odometry = make();
  const Outcome outcome = play(*odometry, usual_events());
  odometry->finish();
  expect_same(odometry->trajectory(), outcome.trajectory);

  const auto idle = make();
  idle->finish();
  EXPECT_TRUE(idle->trajectory().empty());
  EXPECT_TRUE(idle->map().empty());
  EXPECT_TRUE(idle->registered_scan().empty());
}

std::string name_of(const testing::TestParamInfo<Candidate>& candidate) {
  const auto& [algorithm, preset] = candidate.param;
  std::string name = algorithm + (preset.empty() ? "" : "_" + preset);
  std::replace(name.begin(), name.end(), '+', '_');
  return name;
}

INSTANTIATE_TEST_SUITE_P(All, OdometryConformance, testing::ValuesIn(candidates()), name_of);

}  // namespace
}  // namespace lidarena::odometry
