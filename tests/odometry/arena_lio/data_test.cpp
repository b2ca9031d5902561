// SPDX-License-Identifier: BSD-3-Clause
// Tests of arena_lio with faulty data, and of what it says about them.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "lidarena/base/random.hpp"
#include "lidarena/base/so3.hpp"
#include "lidarena/base/time.hpp"
#include "lidarena/odometry/arena_lio/arena_lio.hpp"
#include "tests/odometry/playback.hpp"

namespace lidarena::odometry::arena_lio {
namespace {

using synthetic::Outcome;
using synthetic::Recording;
using synthetic::usual_events;
using synthetic::with_imu;

constexpr double kTracked = 0.1;  // m; the map's voxels have 0.2 m, lost tracking gives meters

/// The results; those that have poses in the trajectory with these, which stand in one world.
Outcome play(const std::vector<Event>& events, const Recording& recording = {}) {
  const Rig rig = synthetic::rig_of(recording);
  ArenaLio odometry(settings_for(rig.lidars.front()), rig.lidars.front(), rig.imus.front(),
                    Parallel(1));
  Outcome outcome = synthetic::play(events, odometry);
  odometry.finish();
  const Trajectory trajectory = odometry.trajectory();
  for (ScanResult& result : outcome.results) {
    if (const auto pose = trajectory.at(result.estimate.stamp))
      result.estimate.world_from_body = *pose;
  }
  return outcome;
}

double seconds_of(const ImuSample& sample) { return to_seconds(sample.stamp - Recording{}.epoch); }

/// No IMU samples between `begin` and `end` (s), while the body moves at about 0.5 m/s and turns.
Outcome with_silence(double begin, double end) {
  return play(with_imu([=](const ImuSample& sample) {
    return seconds_of(sample) < begin || seconds_of(sample) > end;
  }));
}

TEST(ArenaLioData, AShortSilenceOfTheImuIsBridgedAndTold) {
  const Outcome outcome = with_silence(2.5, 2.8);
  EXPECT_LT(outcome.final_error({}), kTracked);
  EXPECT_EQ(outcome.count(ScanStatus::kDiverged), 0U);
  EXPECT_GT(outcome.largest_detail("imu_gap_s"), 0.09);
}

TEST(ArenaLioData, AnImuThatFallsSilentLeavesALidarOdometryThatSaysSo) {
  const Outcome outcome = with_silence(2.5, 100.0);
  EXPECT_LT(outcome.final_error({}), kTracked);
  EXPECT_GT(outcome.results.back().detail("imu_gap_s").value(), 0.05);
}

TEST(ArenaLioData, ALostTrackIsNotSilentAndDoesNotSpoilTheMap) {
  // For half a second there are neither scans nor IMU samples, and the body is moved by 2.5 m.
  const Recording recording{.motion =
                                [](double t) {
                                  Pose pose = synthetic::flight(t);
                                  if (t > 2.25) pose.translation() += Eigen::Vector3d(2, -1.5, 0.5);
                                  return pose;
                                },
                            .seconds = 5.0};
  std::vector<Event> events;
  for (Event& event : synthetic::record(recording)) {
    const Time stamp = std::visit([](const auto& data) { return data.stamp; }, event.data);
    const double t = to_seconds(stamp - recording.epoch);
    if (t < 2.0 || t > 2.5) events.push_back(std::move(event));
  }
  const Outcome outcome = play(events, recording);
  ASSERT_EQ(outcome.results.size(), 44U);
  EXPECT_GT(outcome.final_error(recording), 1.0) << "tracking should be lost";
  for (std::size_t i = 20; i < 44; ++i) {
    EXPECT_NE(outcome.results[i].status, ScanStatus::kTracked) << i;
    EXPECT_EQ(outcome.results[i].detail("map_points").value(),
              outcome.results[19].detail("map_points").value());
  }
  EXPECT_EQ(outcome.results.back().status, ScanStatus::kDiverged) << "after 1.5 seconds";
}

TEST(ArenaLioData, SamplesFromThePastAndFromFarAheadAreRefusedAndCounted) {
  std::vector<Event> events;
  int bad = 0;
  for (const Event& event : usual_events()) {
    events.push_back(event);
    const auto* sample = std::get_if<ImuSample>(&event.data);
    if (sample == nullptr || ++bad % 50 != 0) continue;
    ImuSample wrong = *sample;
    wrong.gyro.setConstant(3.0);
    wrong.stamp += from_seconds(bad % 100 == 0 ? 3600.0 : -0.5);
    events.push_back({"imu", wrong});
  }
  const Outcome outcome = play(events);
  EXPECT_LT(outcome.final_error({}), kTracked);
  EXPECT_NEAR(static_cast<double>(outcome.results.back().detail("imu_refused").value()), bad / 50,
              1.0)
      << "the last stamp from far ahead may not be detected yet";
  EXPECT_EQ(outcome.count(ScanStatus::kTracked), 39U) << "all but the first";
}

TEST(ArenaLioData, AScanFromThePastChangesNothing) {
  std::vector<Event> events;
  std::optional<Event> old;
  int index = 0;
  for (const Event& event : usual_events()) {
    events.push_back(event);
    if (!std::holds_alternative<Scan>(event.data)) continue;
    if (index == 10) old = event;
    if (++index == 25) events.push_back(*old);
  }
  const Outcome outcome = play(events);
  const ScanResult& refused = outcome.results[25];
  EXPECT_EQ(refused.status, ScanStatus::kRefused);
  EXPECT_EQ(refused.estimate.stamp, outcome.results[24].estimate.stamp);
  const Outcome usual = play(usual_events());
  EXPECT_EQ(outcome.results.back().estimate.world_from_body.matrix(),
            usual.results.back().estimate.world_from_body.matrix());
}

TEST(ArenaLioData, DroppedScansAreBridgedByTheImu) {
  std::vector<Event> events;
  int index = 0;
  for (const Event& event : usual_events()) {
    const bool dropped = std::holds_alternative<Scan>(event.data) && ++index > 20 && index <= 23;
    if (!dropped) events.push_back(event);
  }
  const Outcome outcome = play(events);
  EXPECT_EQ(outcome.results.size(), 37U);
  EXPECT_LT(outcome.final_error({}), kTracked);
  EXPECT_EQ(outcome.count(ScanStatus::kTracked), 36U);
}

TEST(ArenaLioData, TheMotionWithinAScanIsThatOfTheFlight) {
  const Outcome outcome = play(usual_events());
  EXPECT_TRUE(outcome.results.front().motion.empty()) << "it starts with the first scan's end";
  for (std::size_t i = 10; i < outcome.results.size(); ++i) {
    const ScanResult& result = outcome.results[i];
    ASSERT_GT(result.motion.size(), 15U) << "an IMU at 200 Hz";
    EXPECT_EQ(result.motion.back().stamp, result.estimate.stamp);
    for (const StampedPose& pose : result.motion) {
      const Pose moved = pose.world_from_body.inverse() * result.estimate.world_from_body;
      const Pose expected = synthetic::truth({}, pose.stamp, result.estimate.stamp);
      EXPECT_LT((moved.translation() - expected.translation()).norm(), 0.003) << i;
    }
  }
}

TEST(ArenaLioData, AnImuThatStartsLateIsWaitedForAndThenStartsInMotion) {
  const Outcome outcome =
      play(with_imu([](const ImuSample& sample) { return seconds_of(sample) > 2.45; }));
  EXPECT_EQ(outcome.count(ScanStatus::kInitializing), 29U)
      << "25 without IMU samples, and four whose poses are still revised";
  EXPECT_EQ(outcome.count(ScanStatus::kTracked), 11U);
  Outcome tracked;
  tracked.results.assign(outcome.results.begin() + 29, outcome.results.end());
  EXPECT_LT(tracked.final_error({}), kTracked);
}

TEST(ArenaLioData, AStartInMotionIsSurvived) {
  const Recording moving{.motion = [](double t) { return synthetic::flight(t + 2.5); }};
  EXPECT_LT(play(synthetic::record(moving), moving).final_error(moving), kTracked);
}

TEST(ArenaLioData, AStartAtThreeMetersPerSecondIsSurvivedToo) {
  // The second scan is 0.3 m from the first, a cell of the map.
  const Recording fast{
      .motion =
          [](double t) {
            const Eigen::Vector3d position(3.0 * std::sin(t), 2.0 - 2.0 * std::cos(t),
                                           0.3 * std::sin(2.0 * t));
            return make_pose(so3::exp({0.0, 0.0, 0.6 * std::sin(1.5 * t)}), position);
          },
      .points_per_scan = 20480,
      .repeating = false};
  EXPECT_LT(play(synthetic::record(fast), fast).final_error(fast), kTracked);
}

TEST(ArenaLioData, AStartInASteepTurnIsAsGoodAsOneAtRest) {
  // On a circle at 4 m/s, without leaning: the mean force, by which the start guesses where up is,
  // is 39 degrees off.
  const Recording turning{.motion =
                              [](double t) {
                                const Eigen::Vector3d position(2.0 * std::sin(2.0 * t),
                                                               2.0 - 2.0 * std::cos(2.0 * t),
                                                               0.3 * std::sin(t));
                                return make_pose(so3::exp({0.0, 0.0, std::sin(3.0 * t)}), position);
                              },
                          .points_per_scan = 20480,
                          .repeating = false};
  const Outcome outcome = play(synthetic::record(turning), turning);
  EXPECT_LT(outcome.final_error(turning), 0.01);
  EXPECT_EQ(outcome.count(ScanStatus::kDegenerate), 0U);
}

TEST(ArenaLioData, AccelerationsInGAreRecognizedAndSaid) {
  const Outcome in_g = play(with_imu([](ImuSample& sample) {
    sample.accel /= 9.80665;
    return true;
  }));
  EXPECT_NEAR(in_g.results.back().detail("accel_scale").value(), 9.80665, 1e-9);
  EXPECT_LT(in_g.final_error({}), kTracked);
  EXPECT_EQ(play(usual_events()).results.back().detail("accel_scale").value(), 1.0);
}

/// Turns back and forth with up to 3 rad/s; the gyro's range ends at 2.2 rad/s.
Pose fast_turning(double t) {
  const double u = std::max(0.0, t - 1.0);
  const double yaw = 0.5 * (1.0 - std::cos(6.0 * u)) * std::min(1.0, u);
  return make_pose(so3::exp({0.0, 0.0, yaw}), synthetic::flight(0.0).translation());
}

TEST(ArenaLioData, ASaturatedGyroIsToldAndNotBelieved) {
  const Recording recording{.motion = fast_turning};
  std::vector<Event> events = synthetic::record(recording);
  SequentialRandom random(1, 1);
  int clipped = 0;
  for (Event& event : events) {
    auto* sample = std::get_if<ImuSample>(&event.data);
    if (sample == nullptr) continue;
    for (double& rate : sample->gyro) rate += 1e-3 * random.normal();
    clipped += std::abs(sample->gyro.z()) > 2.2 ? 1 : 0;
    sample->gyro = sample->gyro.cwiseMin(2.2).cwiseMax(-2.2);
  }
  ASSERT_GT(clipped, 50);
  const Outcome outcome = play(events, recording);
  EXPECT_GT(outcome.largest(&ScanCounters::imu_saturated), 5.0);
  EXPECT_LT(outcome.final_error(recording), kTracked);
  EXPECT_EQ(outcome.count(ScanStatus::kDiverged), 0U);
  EXPECT_EQ(play(usual_events()).largest(&ScanCounters::imu_saturated), 0.0);
}

/// Shakes along x with up to 24 m/s^2; the accelerometer's range ends at 2 g.
Pose shaking(double t) {
  const double u = std::clamp(t - 1.0, 0.0, 1.0);
  const double ramp = u * u * u * (10.0 - 15.0 * u + 6.0 * u * u);
  Pose pose = synthetic::flight(0.0);
  pose.translation().x() += 0.06 * ramp * std::sin(20.0 * (t - 1.0));
  return pose;
}

TEST(ArenaLioData, ASaturatedAccelerometerIsToldAndNotBelieved) {
  constexpr double kRange = 2.0 * 9.80665;
  const Recording recording{.motion = shaking};
  std::vector<Event> events = synthetic::record(recording);
  SequentialRandom random(2, 1);
  int clipped = 0;
  for (Event& event : events) {
    auto* sample = std::get_if<ImuSample>(&event.data);
    if (sample == nullptr) continue;
    for (double& force : sample->accel) force += 1e-2 * random.normal();
    clipped += sample->accel.cwiseAbs().maxCoeff() > kRange ? 1 : 0;
    sample->accel = sample->accel.cwiseMin(kRange).cwiseMax(-kRange);
  }
  ASSERT_GT(clipped, 50);
  const Outcome outcome = play(events, recording);
  EXPECT_GT(outcome.largest(&ScanCounters::imu_saturated), 2.0);
  EXPECT_LT(outcome.final_error(recording), kTracked);
  EXPECT_EQ(outcome.count(ScanStatus::kDiverged), 0U);
}

TEST(ArenaLioData, AClockThatIsSetBackForGoodChangesNothingAndIsToldAtEachScan) {
  std::vector<Event> events = usual_events();
  const Time from = Recording{}.epoch + from_seconds(2.0);
  for (Event& event : events) {
    std::visit(
        [from](auto& data) {
          if (data.stamp >= from) data.stamp -= from_seconds(1.5);
        },
        event.data);
  }
  const Outcome outcome = play(events);
  ASSERT_EQ(outcome.results.size(), 40U);
  // Scans 20 to 34 have the stamps 0.5 to 1.9 s again.
  for (std::size_t i = 20; i < 35; ++i) {
    EXPECT_EQ(outcome.results[i].status, ScanStatus::kRefused) << i;
    EXPECT_EQ(outcome.results[i].estimate.world_from_body.matrix(),
              outcome.results[19].estimate.world_from_body.matrix());
  }
  // From 2 s on, stamps are later than all before, also those of the IMU.
  EXPECT_EQ(outcome.count(ScanStatus::kRefused), 15U);
  EXPECT_GT(outcome.results.back().detail("imu_refused").value(), 0.0);
}

}  // namespace
}  // namespace lidarena::odometry::arena_lio
