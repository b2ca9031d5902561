// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/evaluation/diagnosis/time_offset.hpp"

#include <gtest/gtest.h>

#include "flights.hpp"

namespace lidarena::evaluation {
namespace {

using namespace std::chrono_literals;
using flights::sample;
using flights::tour;

TEST(TimeOffset, FindsHowLateTheStampsAre) {
  const Trajectory truth = sample(tour, 5ms, 30s);
  for (const Time late : {Time(0ms), Time(13ms), Time(-87ms), Time(237ms)}) {
    const auto found = time_offset(flights::shifted(sample(tour, 100ms, 30s), late), truth);
    ASSERT_TRUE(found);
    EXPECT_NEAR(found->late_s, to_seconds(late), 1e-4);  // parabola on a 10 ms grid
  }
}

TEST(TimeOffset, WithNoiseStaysWithinItsOwnUncertainty) {
  SequentialRandom random(11);
  const Trajectory truth = sample(tour, 5ms, 60s);
  const Trajectory noisy = flights::mapped(
      flights::shifted(sample(tour, 100ms, 60s), 40ms), [&](const StampedPose& pose) {
        const Eigen::Vector3d noise(random.normal(), random.normal(), random.normal());
        return flights::level(0.01 * noise) * pose.world_from_body;
      });
  const auto found = time_offset(noisy, truth);
  ASSERT_TRUE(found);
  EXPECT_GT(found->sigma_s, 1e-4);
  EXPECT_NEAR(found->late_s, 0.040, 4.0 * found->sigma_s);
}

TEST(TimeOffset, SteadyFlightAndHoverDoNotShowIt) {
  const auto line = [](double t) { return flights::level({t, 0, 0}); };
  const auto still = [](double) { return flights::level({1, 2, 3}); };
  for (const auto& motion :
       {std::function<Pose(double)>(line), std::function<Pose(double)>(still)}) {
    SequentialRandom random(12);
    const Trajectory truth = sample(motion, 5ms, 30s);
    const Trajectory noisy =
        flights::mapped(sample(motion, 100ms, 30s), [&](const StampedPose& pose) {
          const Eigen::Vector3d noise(random.normal(), random.normal(), random.normal());
          return flights::level(0.01 * noise) * pose.world_from_body;
        });
    EXPECT_FALSE(time_offset(noisy, truth));
  }
  EXPECT_FALSE(time_offset(Trajectory(), sample(line, 5ms, 30s)));
  EXPECT_FALSE(time_offset(sample(line, 5ms, 30s), Trajectory()));
}

}  // namespace
}  // namespace lidarena::evaluation
