// SPDX-License-Identifier: BSD-3-Clause
// Tests of arena_lio at a standstill and at the first motion.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include "lidarena/odometry/arena_lio/arena_lio.hpp"
#include "tests/odometry/playback.hpp"

namespace lidarena::odometry::arena_lio {
namespace {

using synthetic::Outcome;
using synthetic::Recording;

Outcome play_standing(const std::vector<Event>& events, const Recording& recording = {}) {
  const Rig rig = synthetic::rig_of(recording);
  ArenaLio odometry(settings_for(rig.lidars.front()), rig.lidars.front(), rig.imus.front(),
                    Parallel(1));
  return synthetic::play(events, odometry);
}

TEST(ArenaLioStanding, BeforeItFirstMovesTheBodyIsWhereItBegan) {
  const Recording standing{.motion = [](double) { return Pose::Identity(); }};
  double farthest = 0.0;
  for (const ScanResult& r : play_standing(synthetic::record(standing), standing).results)
    farthest = std::max(farthest, r.estimate.world_from_body.translation().norm());
  EXPECT_LT(farthest, 1e-3);
}

/// Rests for a second and then moves at 10 cm/s, too gently to be detected by the IMU.
Pose slow_start(double t) {
  Pose pose = Pose::Identity();
  const double moving = std::max(0.0, t - 1.0);
  pose.translation().x() = moving < 0.5 ? 0.1 * moving * moving : 0.1 * (moving - 0.25);
  return pose;
}

TEST(ArenaLioStanding, TheFirstMotionIsFollowed) {
  const Recording starting{.motion = slow_start, .seconds = 6.0, .repeating = false};
  const Outcome outcome = play_standing(synthetic::record(starting), starting);
  EXPECT_LT(outcome.final_error(starting), 0.02) << "of 47.5 cm";
}

TEST(ArenaLioStanding, BeamsThatHitTheSamePlacesDoNotHoldTheStart) {
  // With 160 columns the neighbors of a point lie on one line. A plane through them may be
  // perpendicular to the wall and then moves with the sensor.
  const Recording sparse{.motion = slow_start, .seconds = 6.0};
  EXPECT_LT(play_standing(synthetic::record(sparse), sparse).final_error(sparse), 0.05)
      << "of 47.5 cm";
  // 512 columns, as the usual sensor with the fewest
  const Recording usual{.motion = slow_start, .seconds = 3.0, .points_per_scan = 32768};
  EXPECT_LT(play_standing(synthetic::record(usual), usual).final_error(usual), 0.005)
      << "of 17.5 cm";
}

TEST(ArenaLioStanding, ACreepingStartIsFollowedToo) {
  // Rests for a second and then moves at 4 cm/s, which the filter could take for a standstill.
  const auto creep = [](double t) {
    Pose pose = Pose::Identity();
    const double moving = std::max(0.0, t - 1.0);
    pose.translation().x() = moving < 0.5 ? 0.04 * moving * moving : 0.04 * (moving - 0.25);
    return pose;
  };
  const Recording creeping{.motion = creep, .seconds = 6.0, .repeating = false};
  const Outcome outcome = play_standing(synthetic::record(creeping), creeping);
  EXPECT_LT(outcome.final_error(creeping), 0.02) << "of 19 cm";
}

}  // namespace
}  // namespace lidarena::odometry::arena_lio
