// SPDX-License-Identifier: BSD-3-Clause
// Tests of FAST-LIO2 as a whole: standstill, initialization and faulty data.
#include "lidarena/odometry/fast_lio2/fast_lio2.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>

#include "lidarena/base/random.hpp"
#include "lidarena/base/so3.hpp"
#include "lidarena/base/time.hpp"
#include "tests/odometry/synthetic_room.hpp"

namespace lidarena::odometry::fast_lio2 {
namespace {

using synthetic::Recording;

constexpr double kTracked = 0.1;  // m; the map's voxels have 0.2 m, lost tracking gives meters

struct Outcome {
  std::vector<ScanResult> results;

  std::size_t count(ScanStatus status) const {
    return static_cast<std::size_t>(std::count_if(
        results.begin(), results.end(), [&](const ScanResult& r) { return r.status == status; }));
  }
  template <class T>
  T largest(std::optional<T> ScanCounters::*counter) const {
    T value{};
    for (const ScanResult& r : results) value = std::max(value, (r.counters.*counter).value());
    return value;
  }
  /// Error (m) of the last pose relative to the first one.
  double final_error(const Recording& recording) const {
    const StampedPose& first = results.front().estimate;
    const StampedPose& last = results.back().estimate;
    const Pose moved = first.world_from_body.inverse() * last.world_from_body;
    return (moved.translation() -
            synthetic::truth(recording, first.stamp, last.stamp).translation())
        .norm();
  }
};

Config improved(const Recording& recording) {
  return indoor(synthetic::rig_of(recording).lidars.front());
}

Outcome play(const std::vector<dataset::Event>& events, const Recording& recording,
             const Config& config) {
  const Rig rig = synthetic::rig_of(recording);
  FastLio2 odometry(config, rig.lidars.front(), rig.imus.front(), Parallel(1));
  Outcome outcome;
  for (const dataset::Event& event : events) {
    if (const auto* scan = std::get_if<Scan>(&event.data)) {
      outcome.results.push_back(odometry.register_scan(*scan));
    } else {
      odometry.register_imu(std::get<ImuSample>(event.data));
    }
  }
  return outcome;
}

Outcome play(const std::vector<dataset::Event>& events, const Recording& recording = {}) {
  return play(events, recording, improved(recording));
}

const std::vector<dataset::Event>& usual_events() {
  static const std::vector<dataset::Event> events = synthetic::record({});
  return events;
}

double seconds_of(const ImuSample& sample) { return to_seconds(sample.stamp - Recording{}.epoch); }

/// The usual events with `change` applied to each IMU sample; removes the samples for which it
/// returns false.
std::vector<dataset::Event> with_imu(const std::function<bool(ImuSample&)>& change) {
  std::vector<dataset::Event> events;
  for (dataset::Event event : usual_events()) {
    auto* sample = std::get_if<ImuSample>(&event.data);
    if (sample == nullptr || change(*sample)) events.push_back(std::move(event));
  }
  return events;
}

/// No IMU samples between `begin` and `end` (s), while the body moves at about 0.5 m/s and turns.
Outcome with_silence(double begin, double end) {
  return play(with_imu([=](const ImuSample& sample) {
    return seconds_of(sample) < begin || seconds_of(sample) > end;
  }));
}

TEST(FastLio2Standing, BeforeItFirstMovesTheBodyIsWhereItBegan) {
  const Recording standing{.motion = [](double) { return Pose::Identity(); }};
  const std::vector<dataset::Event> events = synthetic::record(standing);
  const auto farthest = [&](bool hold) {
    Config config = improved(standing);
    config.hold_first_pose = hold;
    const Outcome outcome = play(events, standing, config);
    double distance = 0.0;
    for (const ScanResult& r : outcome.results) {
      distance = std::max(distance, r.estimate.world_from_body.translation().norm());
    }
    return distance;
  };
  EXPECT_LT(farthest(true), 1e-3);
  EXPECT_GT(farthest(false), farthest(true));
}

/// Rests for a second and then moves at 10 cm/s, too gently to be detected by the IMU.
Pose slow_start(double t) {
  Pose pose = Pose::Identity();
  const double moving = std::max(0.0, t - 1.0);
  pose.translation().x() = moving < 0.5 ? 0.1 * moving * moving : 0.1 * (moving - 0.25);
  return pose;
}

TEST(FastLio2Standing, TheFirstMotionIsFollowed) {
  const Recording starting{.motion = slow_start, .seconds = 6.0, .repeating = false};
  const Outcome outcome = play(synthetic::record(starting), starting);
  EXPECT_LT(outcome.final_error(starting), 0.02) << "of 47.5 cm";
}

TEST(FastLio2Standing, BeamsThatHitTheSamePlacesDoNotHoldTheStart) {
  // With 160 columns the neighbors of a point lie on one line. A plane through them may be
  // perpendicular to the wall and then moves with the sensor.
  const Recording sparse{.motion = slow_start, .seconds = 6.0};
  const std::vector<dataset::Event> events = synthetic::record(sparse);
  Config config = improved(sparse);
  EXPECT_LT(play(events, sparse, config).final_error(sparse), 0.05) << "of 47.5 cm";
  config.grid_axes = map::GridAxes::kParallel;  // a rotated grid alone would prevent the error
  EXPECT_LT(play(events, sparse, config).final_error(sparse), 0.05);
  config.plane_uncertainty = false;
  EXPECT_GT(play(events, sparse, config).final_error(sparse), 0.3);
  // 512 columns, as the usual sensor with the fewest
  const Recording usual{.motion = slow_start, .seconds = 3.0, .points_per_scan = 32768};
  EXPECT_LT(play(synthetic::record(usual), usual).final_error(usual), 0.005) << "of 17.5 cm";
}

TEST(FastLio2Standing, ACreepingStartIsFollowedToo) {
  // Rests for a second and then moves at 4 cm/s, which the filter could take for a standstill.
  const auto creep = [](double t) {
    Pose pose = Pose::Identity();
    const double moving = std::max(0.0, t - 1.0);
    pose.translation().x() = moving < 0.5 ? 0.04 * moving * moving : 0.04 * (moving - 0.25);
    return pose;
  };
  const Recording creeping{.motion = creep, .seconds = 6.0, .repeating = false};
  const Outcome outcome = play(synthetic::record(creeping), creeping);
  EXPECT_LT(outcome.final_error(creeping), 0.02) << "of 19 cm";
}

TEST(FastLio2Data, AShortSilenceOfTheImuIsBridgedAndTold) {
  const Outcome outcome = with_silence(2.5, 2.8);
  EXPECT_LT(outcome.final_error({}), kTracked);
  EXPECT_EQ(outcome.count(ScanStatus::kDiverged), 0U);
  EXPECT_GT(outcome.largest(&ScanCounters::imu_gap_s), 0.09);
}

TEST(FastLio2Data, AnImuThatFallsSilentLeavesALidarOdometryThatSaysSo) {
  const Outcome outcome = with_silence(2.5, 100.0);
  EXPECT_LT(outcome.final_error({}), kTracked);
  EXPECT_GT(outcome.results.back().counters.imu_gap_s.value(), 0.05);
}

TEST(FastLio2Data, ALostTrackIsNotSilentAndDoesNotSpoilTheMap) {
  // For half a second there are neither scans nor IMU samples, and the body is moved by 2.5 m.
  const Recording recording{.motion =
                                [](double t) {
                                  Pose pose = synthetic::flight(t);
                                  if (t > 2.25) pose.translation() += Eigen::Vector3d(2, -1.5, 0.5);
                                  return pose;
                                },
                            .seconds = 5.0};
  std::vector<dataset::Event> events;
  for (dataset::Event& event : synthetic::record(recording)) {
    const Time stamp = std::visit([](const auto& data) { return data.stamp; }, event.data);
    const double t = to_seconds(stamp - recording.epoch);
    if (t < 2.0 || t > 2.5) events.push_back(std::move(event));
  }
  const Outcome outcome = play(events, recording);
  ASSERT_EQ(outcome.results.size(), 44U);
  EXPECT_GT(outcome.final_error(recording), 1.0) << "tracking should be lost";
  for (std::size_t i = 20; i < 44; ++i) {
    EXPECT_NE(outcome.results[i].status, ScanStatus::kTracked) << i;
    EXPECT_EQ(outcome.results[i].counters.map_points.value(),
              outcome.results[19].counters.map_points.value());
  }
  EXPECT_EQ(outcome.results.back().status, ScanStatus::kDiverged) << "after 1.5 seconds";
}

TEST(FastLio2Data, SamplesFromThePastAndFromFarAheadAreRefusedAndCounted) {
  std::vector<dataset::Event> events;
  int bad = 0;
  for (const dataset::Event& event : usual_events()) {
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
  EXPECT_NEAR(outcome.results.back().counters.imu_refused.value(), bad / 50, 1.0)
      << "the last stamp from far ahead may not be detected yet";
  EXPECT_EQ(outcome.count(ScanStatus::kTracked), 39U) << "all but the first";
}

TEST(FastLio2Data, AScanFromThePastChangesNothing) {
  std::vector<dataset::Event> events;
  std::optional<dataset::Event> old;
  int index = 0;
  for (const dataset::Event& event : usual_events()) {
    events.push_back(event);
    if (!std::holds_alternative<Scan>(event.data)) continue;
    if (index == 10) old = event;
    if (++index == 25) events.push_back(*old);
  }
  const Outcome outcome = play(events);
  const ScanResult& refused = outcome.results[25];
  EXPECT_EQ(refused.status, ScanStatus::kTooFewPoints);
  EXPECT_EQ(refused.counters.scans_refused, 1U);
  EXPECT_EQ(refused.estimate.stamp, outcome.results[24].estimate.stamp);
  const Outcome usual = play(usual_events());
  EXPECT_EQ(outcome.results.back().estimate.world_from_body.matrix(),
            usual.results.back().estimate.world_from_body.matrix());
}

TEST(FastLio2Data, DroppedScansAreBridgedByTheImu) {
  std::vector<dataset::Event> events;
  int index = 0;
  for (const dataset::Event& event : usual_events()) {
    const bool dropped = std::holds_alternative<Scan>(event.data) && ++index > 20 && index <= 23;
    if (!dropped) events.push_back(event);
  }
  const Outcome outcome = play(events);
  EXPECT_EQ(outcome.results.size(), 37U);
  EXPECT_LT(outcome.final_error({}), kTracked);
  EXPECT_EQ(outcome.count(ScanStatus::kTracked), 36U);
}

TEST(FastLio2Data, AnImuThatStartsLateIsWaitedForAndThenStartsInMotion) {
  const Outcome outcome =
      play(with_imu([](const ImuSample& sample) { return seconds_of(sample) > 2.45; }));
  EXPECT_EQ(outcome.count(ScanStatus::kInitializing), 26U)
      << "25 without IMU samples, and the first one in the map";
  EXPECT_EQ(outcome.count(ScanStatus::kTracked), 14U);
  Outcome tracked;
  tracked.results.assign(outcome.results.begin() + 25, outcome.results.end());
  EXPECT_LT(tracked.final_error({}), kTracked);
}

TEST(FastLio2Data, AStartInMotionIsSurvived) {
  const Recording moving{.motion = [](double t) { return synthetic::flight(t + 2.5); }};
  EXPECT_LT(play(synthetic::record(moving), moving).final_error(moving), kTracked);
}

TEST(FastLio2Data, AccelerationsInGAreRecognizedAndSaid) {
  const Outcome in_g = play(with_imu([](ImuSample& sample) {
    sample.accel /= 9.80665;
    return true;
  }));
  EXPECT_NEAR(in_g.results.back().counters.accel_scale.value(), 9.80665, 1e-9);
  EXPECT_LT(in_g.final_error({}), kTracked);
  EXPECT_EQ(play(usual_events()).results.back().counters.accel_scale.value(), 1.0);
}

/// Turns back and forth with up to 3 rad/s; the gyro's range ends at 2.2 rad/s.
Pose fast_turning(double t) {
  const double u = std::max(0.0, t - 1.0);
  const double yaw = 0.5 * (1.0 - std::cos(6.0 * u)) * std::min(1.0, u);
  return make_pose(so3::exp({0.0, 0.0, yaw}), synthetic::flight(0.0).translation());
}

TEST(FastLio2Data, ASaturatedGyroIsToldAndNotBelieved) {
  const Recording recording{.motion = fast_turning};
  std::vector<dataset::Event> events = synthetic::record(recording);
  SequentialRandom random(1, 1);
  int clipped = 0;
  for (dataset::Event& event : events) {
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

TEST(FastLio2Data, ASaturatedAccelerometerIsToldAndNotBelieved) {
  constexpr double kRange = 2.0 * 9.80665;
  const Recording recording{.motion = shaking};
  std::vector<dataset::Event> events = synthetic::record(recording);
  SequentialRandom random(2, 1);
  int clipped = 0;
  for (dataset::Event& event : events) {
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

TEST(FastLio2Data, AClockThatIsSetBackForGoodChangesNothingAndIsToldAtEachScan) {
  std::vector<dataset::Event> events = usual_events();
  const Time from = Recording{}.epoch + from_seconds(2.0);
  for (dataset::Event& event : events) {
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
    EXPECT_EQ(outcome.results[i].status, ScanStatus::kTooFewPoints) << i;
    EXPECT_EQ(outcome.results[i].counters.scans_refused, i - 19);
    EXPECT_EQ(outcome.results[i].estimate.world_from_body.matrix(),
              outcome.results[19].estimate.world_from_body.matrix());
  }
  // From 2 s on, stamps are later than all before, also those of the IMU.
  EXPECT_EQ(outcome.results.back().counters.scans_refused, 15U);
  EXPECT_GT(outcome.results.back().counters.imu_refused.value(), 0U);
}

}  // namespace
}  // namespace lidarena::odometry::fast_lio2
