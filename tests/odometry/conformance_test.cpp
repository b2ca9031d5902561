// SPDX-License-Identifier: BSD-3-Clause
// Tests that every odometry of the factory must pass with each of its presets but `tuned`.
// Instantiated from the factory's list, so a new algorithm is tested as soon as it is listed.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "lidarena/base/so3.hpp"
#include "lidarena/odometry/factory.hpp"
#include "tests/odometry/measured_errors.hpp"
#include "tests/odometry/synthetic_room.hpp"

namespace lidarena::odometry {
namespace {

using synthetic::Recording;

struct Candidate {
  std::string algorithm;
  std::string preset;
};

/// For the names of the tests, which would else show its bytes.
void PrintTo(const Candidate& candidate, std::ostream* out) {
  *out << candidate.algorithm << ":" << candidate.preset;
}

std::vector<Candidate> candidates() {
  std::vector<Candidate> all;
  for (const AlgorithmInfo& info : list_algorithms()) {
    for (const std::string& preset : info.presets) {
      // `tuned` has other values of keys that the presets before it set; with fine cells it takes
      // minutes here.
      if (preset != "tuned") all.push_back({info.name, preset});
    }
    if (info.presets.empty()) all.push_back({info.name, ""});
  }
  return all;
}

const std::vector<Event>& usual_events() {
  static const std::vector<Event> events = synthetic::record({});
  return events;
}

struct Outcome {
  std::vector<ScanResult> results;
  Trajectory trajectory;
};

/// Feeds one event; appends the result of a scan.
void feed(Odometry& odometry, const Event& event, std::vector<ScanResult>& results) {
  if (const auto* scan = std::get_if<Scan>(&event.data)) {
    results.push_back(odometry.register_scan(*scan));
  } else {
    odometry.register_imu(std::get<ImuSample>(event.data));
  }
}

/// `x` rounded up to two significant digits.
double rounded_up(double x) {
  const double unit = std::pow(10.0, std::floor(std::log10(x)) - 1.0);
  return std::ceil(x / unit) * unit;
}

class OdometryConformance : public testing::TestWithParam<Candidate> {
 protected:
  static std::unique_ptr<Odometry> make(const Recording& recording = {}, int threads = 1) {
    const auto& [algorithm, preset] = GetParam();
    return make_odometry({algorithm, preset, "", {}}, synthetic::rig_of(recording), "lidar",
                         Parallel(threads))
        .odometry;
  }
  static Outcome play(Odometry& odometry, const std::vector<Event>& events) {
    Outcome outcome;
    for (const Event& event : events) feed(odometry, event, outcome.results);
    odometry.finish();
    outcome.trajectory = odometry.trajectory();
    return outcome;
  }
  static Outcome play(const Recording& recording) {
    const auto odometry = make(recording);
    return play(*odometry, synthetic::record(recording));
  }
  /// At most twice the error (m) that was measured when the method's row was last entered.
  static void expect_as_measured(Situation situation, double error_m) {
    const std::string name(name_of(situation));
    RecordProperty(name + "_error_m", testing::PrintToString(error_m));
    const auto& [algorithm, preset] = GetParam();
    const std::string method = algorithm + (preset.empty() ? "" : ":" + preset);
    const std::optional<double> measured = measured_error(method, situation);
    if (measured) {
      EXPECT_LE(error_m, 2.0 * *measured) << name;
    } else {
      ADD_FAILURE() << "tests/odometry/measured_errors.cpp has no error of " << method << " in the "
                    << "situation " << name << "; enter "
                    << static_cast<float>(rounded_up(error_m));
    }
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

/// Largest motion (m) from the first pose, of a point 5 m away.
double largest_motion(const Trajectory& estimate) {
  const Pose& first = estimate.poses().front().world_from_body;
  double largest = 0.0;
  for (const StampedPose& pose : estimate.poses()) {
    const Pose moved = first.inverse() * pose.world_from_body;
    largest = std::max(largest, moved.translation().norm() + 5.0 * so3::angle(moved.linear()));
  }
  return largest;
}

/// Distance (m) from the walls, seen from `viewpoint`, below which 90 % of the points lie (pillars
/// may hide a few points from there).
double distance_of_most(const std::vector<Eigen::Vector3f>& points, const Pose& room_from_world,
                        const Eigen::Vector3d& viewpoint) {
  std::vector<double> gaps;
  for (const Eigen::Vector3f& point : points) {
    const Eigen::Vector3d p = room_from_world * point.cast<double>();
    const double range = (p - viewpoint).norm();
    gaps.push_back(std::abs(range - synthetic::cast(viewpoint, (p - viewpoint) / range)));
  }
  std::ranges::sort(gaps);
  return gaps[gaps.size() * 9 / 10];
}

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
  expect_as_measured(Situation::kFlight, largest_error({}, outcome.trajectory));
}

TEST_P(OdometryConformance, TwoInstancesInterleavedDoAsEachAlone) {
  const Recording other{.range_noise_m = 0.02, .epoch = Time{77}};
  const std::vector<Event> other_events = synthetic::record(other);
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
  std::vector<Event> events = usual_events();
  std::size_t index = 0;
  for (Event& event : events) {
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
  expect_as_measured(Situation::kFaultyScans, largest_error({}, outcome.trajectory));
}

TEST_P(OdometryConformance, AFirstScanWithoutPointsIsSurvived) {
  std::vector<Event> events = usual_events();
  for (Event& event : events) {
    auto* scan = std::get_if<Scan>(&event.data);
    if (scan == nullptr) continue;
    scan->points.clear();
    break;
  }
  const Outcome outcome = play(*make(), events);
  EXPECT_EQ(outcome.results.front().status, ScanStatus::kTooFewPoints);
  EXPECT_EQ(outcome.results.back().status, ScanStatus::kTracked);
  expect_as_measured(Situation::kEmptyFirstScan, largest_error({}, outcome.trajectory));
}

TEST_P(OdometryConformance, WhereAndHowTheFlightStartsDoesNotMatter) {
  const Pose elsewhere = make_pose(so3::exp({0, 0, 2.0}), {1.0, -1.5, 0.2});
  const Recording moved{.motion = [&](double t) { return elsewhere * synthetic::flight(t); }};
  expect_as_measured(Situation::kElsewhere, largest_error(moved, play(moved).trajectory));
}

TEST_P(OdometryConformance, AStartInMotionCostsWhatWasMeasured) {
  const Recording moving{.motion = [](double t) { return synthetic::flight(t + 3.0); }};
  expect_as_measured(Situation::kMoving, largest_error(moving, play(moving).trajectory));
}

TEST_P(OdometryConformance, RotorsThatShakeTheImuCostWhatWasMeasured) {
  const Recording vibrating{.vibrating = true};
  expect_as_measured(Situation::kVibrating, largest_error(vibrating, play(vibrating).trajectory));
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
  expect_as_measured(Situation::kMounted, largest_error(mounted, play(mounted).trajectory));
}

TEST_P(OdometryConformance, StandingStillItStaysPut) {
  // beams that change from scan to scan make point-to-point methods wander (KISS-ICP's README)
  const Recording still{.motion = [](double) { return synthetic::flight(0.0); }, .repeating = true};
  expect_as_measured(Situation::kStanding, largest_motion(play(still).trajectory));
}

TEST_P(OdometryConformance, ItSaysHowMuchMemoryItsMapTakes) {
  const auto odometry = make();
  play(*odometry, usual_events());
  const MemoryUse memory = odometry->memory();
  for (const std::uint64_t bytes : {memory.map, memory.scan_buffer, memory.backlog, memory.other})
    EXPECT_LT(bytes, 1U << 30U);
  EXPECT_GE(memory.map, odometry->map().size() * sizeof(float));
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
  expect_as_measured(Situation::kMap, distance_of_most(points, room_from_world,
                                                       synthetic::flight(3.0).translation()));
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
