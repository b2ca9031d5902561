// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/flight/figures.hpp"

#include <gtest/gtest.h>

namespace lidarena::flight {
namespace {

/// 10 s: 3 m/s in the first two seconds, rotation at 2 rad/s in the third, slow motion afterwards.
class StagedFlight final : public Flight {
 public:
  Motion at(Time t) const override {
    Motion motion;
    if (t < std::chrono::seconds(2)) {
      motion.velocity_world.y() = 3.0;
    } else if (t < std::chrono::seconds(3)) {
      motion.angular_rate_body.x() = 2.0;
    } else {
      motion.velocity_world.x() = 1.9;
      motion.angular_rate_body.z() = 1.5;
    }
    return motion;
  }
  Time duration() const override { return std::chrono::seconds(10); }
};

TEST(Figures, LivelyIsTheShareOfTimeThatIsFastOrTurnsQuickly) {
  const FlightFigures figures = figures_of(StagedFlight{});
  EXPECT_NEAR(figures.fast_share, 0.3, 1e-3);  // samples are 1 ms apart
  EXPECT_EQ(figures.max_speed, 3.0);
  EXPECT_EQ(figures.max_angular_rate, 2.0);
}

}  // namespace
}  // namespace lidarena::flight
