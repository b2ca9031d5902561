// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/flight/spline_flight.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "lidarena/base/error.hpp"
#include "lidarena/flight/figures.hpp"
#include "tests/flight/flight_conformance.hpp"

namespace lidarena::flight {
namespace {

using Eigen::Vector3d;
using std::numbers::pi;
using testing::HasSubstr;

constexpr Time kMs = std::chrono::milliseconds(1);

/// Right angles, a slope, a shallow bend, a short segment, and a sharp corner.
std::vector<Vector3d> crooked() {
  return {{0, 0, 1}, {4, 0, 1}, {4, 3, 1.5}, {0.5, 3, 2}, {0, 3.3, 2}, {-4, 4, 1}, {-1, 3.2, 1}};
}

double distance_to_line(const Vector3d& p, const std::vector<Vector3d>& line) {
  double nearest = std::numeric_limits<double>::infinity();
  for (std::size_t i = 1; i < line.size(); ++i) {
    const Vector3d d = line[i] - line[i - 1];
    const double s = std::clamp(d.dot(p - line[i - 1]) / d.squaredNorm(), 0.0, 1.0);
    nearest = std::min(nearest, (p - line[i - 1] - s * d).norm());
  }
  return nearest;
}

/// Yaw of the flat outputs: the attitude without its tilt.
double yaw_of(const Pose& pose) {
  const Vector3d z = pose.linear().col(2);
  const Eigen::Matrix3d tilt =
      Eigen::Quaterniond::FromTwoVectors(Vector3d::UnitZ(), z).toRotationMatrix();
  const Eigen::Matrix3d turn = tilt.transpose() * pose.linear();
  return std::atan2(turn(1, 0), turn(0, 0));
}

std::string error_of(const std::vector<Vector3d>& waypoints, const FlightConfig& config) {
  try {
    SplineFlight(waypoints, config, "here.yaml");
  } catch (const InputError& e) {
    return e.what();
  }
  return "no error";
}

class Styles : public testing::TestWithParam<FlightStyle> {
 protected:
  FlightConfig config() const {
    FlightConfig config;
    config.style = GetParam();
    return config;
  }
};
INSTANTIATE_TEST_SUITE_P(All, Styles,
                         testing::Values(FlightStyle::kGentle, FlightStyle::kBrisk,
                                         FlightStyle::kAggressive));

TEST_P(Styles, StatedDerivativesAreThoseOfTheMotion) {
  FlightConfig sweeping = config();
  sweeping.heading = {.mode = HeadingMode::kSweep, .amplitude = 0.3, .period_s = 4.0};
  conformance::expect_lawful(SplineFlight(crooked(), config(), "test"), 2);
  conformance::expect_lawful(SplineFlight(crooked(), sweeping, "test"), 2);
}

TEST_P(Styles, EveryLimitHoldsAtEveryInstant) {
  for (const HeadingMode mode :
       {HeadingMode::kAlongPath, HeadingMode::kFixed, HeadingMode::kSweep}) {
    FlightConfig c = config();
    c.heading = {.mode = mode, .amplitude = 0.2, .period_s = 4.0};
    const SplineFlight flight(crooked(), c, "test");
    const FlightLimits limits = limits_of(c);
    const double slack = 1.0 + 1e-9;  // for rounding only
    for (Time t{0}; t < flight.duration(); t += kMs) {
      const Motion now = flight.at(t);
      const Motion next = flight.at(t + kMs);
      const Vector3d z = now.world_from_body.linear().col(2);
      ASSERT_LE(now.velocity_world.norm(), limits.max_speed * slack);
      ASSERT_LE(now.acceleration_world.norm(), limits.max_acceleration * slack);
      // a difference over 1 ms is an average of the jerk, to which the same limit applies
      const Vector3d gained = next.acceleration_world - now.acceleration_world;
      ASSERT_LE(gained.norm(), limits.max_jerk * 1e-3 * (1.0 + 1e-6));
      ASSERT_LE(std::atan2(z.head<2>().norm(), z.z()), limits.max_tilt * slack);
      const double turned =
          std::remainder(yaw_of(next.world_from_body) - yaw_of(now.world_from_body), 2.0 * pi);
      ASSERT_LE(std::abs(turned), limits.max_yaw_rate * 1e-3 * (1.0 + 1e-6));
    }
  }
}

TEST_P(Styles, ThePathStaysInsideTheCorridorAroundTheLineAndPassesEveryCorner) {
  for (const double corner : {0.02, 0.15, 0.5}) {
    FlightConfig c = config();
    c.corner_m = corner;
    const auto line = crooked();
    const SplineFlight flight(line, c, "test");
    std::vector<double> nearest(line.size(), std::numeric_limits<double>::infinity());
    for (Time t{0}; t <= flight.duration(); t += kMs) {
      const Vector3d p = flight.pose_at(t).translation();
      ASSERT_LE(distance_to_line(p, line), corner);
      for (std::size_t i = 0; i < line.size(); ++i) {
        nearest[i] = std::min(nearest[i], (p - line[i]).norm());
      }
    }
    // two samples are at most 5 m/s * 1 ms apart
    EXPECT_THAT(nearest, testing::Each(testing::Le(corner + 0.0025)));
  }
}

TEST_P(Styles, RestsUprightAtTheFirstWaypointBeforeAndAtTheLastAfterwards) {
  const SplineFlight flight(crooked(), config(), "test");
  const Time hover = from_seconds(config().hover_s);
  for (const auto& [t, waypoint] : {std::pair{Time{0}, crooked().front()},
                                    {hover, crooked().front()},
                                    {flight.duration() - hover, crooked().back()},
                                    {flight.duration(), crooked().back()}}) {
    const Motion m = flight.at(t);
    // the rounding of the last knots is multiplied by knot^-4 in the angular acceleration
    EXPECT_NEAR((m.world_from_body.translation() - waypoint).norm(), 0.0, 1e-12);
    EXPECT_NEAR(m.velocity_world.norm(), 0.0, 1e-11);
    EXPECT_NEAR(m.acceleration_world.norm(), 0.0, 1e-10);
    EXPECT_NEAR(m.angular_rate_body.norm(), 0.0, 1e-9);
    EXPECT_NEAR(m.angular_acceleration_body.norm(), 0.0, 1e-8);
    EXPECT_NEAR(m.world_from_body.linear()(2, 2), 1.0, 1e-12);
  }
  EXPECT_GT(flight.at(hover + from_seconds(0.7)).velocity_world.norm(), 0.0);
}

TEST_P(Styles, ThrustAlongTheBodysZAxisExplainsTheAcceleration) {
  const SplineFlight flight(crooked(), config(), "test");
  for (Time t{0}; t < flight.duration(); t += 7 * kMs) {
    const Motion m = flight.at(t);
    const Vector3d thrust = m.acceleration_world + kGravity * Vector3d::UnitZ();
    const Vector3d in_body = m.world_from_body.linear().transpose() * thrust;
    ASSERT_NEAR(in_body.head<2>().norm(), 0.0, 1e-12);
    ASSERT_GT(in_body.z(), 0.0);
  }
}

TEST(SplineFlight, AStraightLineTakesTheTimeOfAccelerationCruiseAndBrake) {
  FlightConfig config;
  config.hover_s = 0.5;
  config.corner_m = 100.0;  // so large that it does not limit the acceleration
  const FlightLimits l = limits_of(FlightStyle::kBrisk);
  const double length = 10.0;
  const std::vector<Vector3d> line{{0, 0, 0}, {length, 0, 0}};
  const SplineFlight flight(line, config, "test");
  const double knot = 2.0 * l.max_acceleration / l.max_jerk;
  const double expected =
      length / l.max_speed + l.max_speed / l.max_acceleration + 2.0 * config.hover_s + 7.0 * knot;
  // The changes from acceleration to cruise and from cruise to braking may be inside a cell of 2
  // cm, in which the acceleration is constant: each adds at most a ds^2 / (8 v^3) to the duration.
  const double lost = l.max_acceleration * 0.02 * 0.02 / (8.0 * std::pow(l.max_speed, 3));
  EXPECT_GT(to_seconds(flight.duration()), expected - 1e-8);
  EXPECT_LT(to_seconds(flight.duration()), expected + 2.0 * lost + 1e-8);
  const FlightFigures figures = figures_of(flight);
  EXPECT_NEAR(figures.max_speed, l.max_speed, 1e-9);
  EXPECT_NEAR(figures.length_m, length, 1e-9);
}

TEST(SplineFlight, AnotherSpeedIsTheSameFlightInAnotherTime) {
  for (const HeadingMode mode : {HeadingMode::kAlongPath, HeadingMode::kFixed}) {
    FlightConfig config;
    config.heading.mode = mode;
    config.hover_s = 1.0;
    const SplineFlight base(crooked(), config, "test");
    for (const double speed : {0.5, 0.8, 1.1}) {
      config.speed = speed;
      const SplineFlight flight(crooked(), config, "test");
      const double moving = to_seconds(base.duration()) - 2.0;
      EXPECT_NEAR(to_seconds(flight.duration()), 2.0 + moving / speed, 1e-6);
      for (double t = 0.0; t < moving; t += 0.05) {
        const Motion a = base.at(from_seconds(1.0 + t));
        const Motion b = flight.at(from_seconds(1.0 + t / speed));
        // The hover shifts the spline's knots along the path, by less than one of them.
        EXPECT_LT((a.world_from_body.translation() - b.world_from_body.translation()).norm(), 0.01);
        EXPECT_LT((speed * a.velocity_world - b.velocity_world).norm(), 0.06) << speed;
      }
    }
    config.speed = 1.0;
  }
}

TEST(SplineFlight, ARightAngleIsFlownAtTheSpeedThatItsArcAllows) {
  FlightConfig config;
  config.limits.max_yaw_rate = 100.0;
  const std::vector<Vector3d> line{{0, 0, 0}, {10, 0, 0}, {10, 10, 0}};
  const SplineFlight flight(line, config, "test");
  const FlightLimits l = limits_of(config);
  const double knot = 2.0 * l.max_acceleration / l.max_jerk;
  const double smoothed = 0.5 * l.max_acceleration * SplineFlight::Spline::kVariance * knot * knot;
  const double radius = (config.corner_m - smoothed) / (std::sqrt(2.0) - 1.0);
  const double arc_speed = std::sqrt(0.8 * l.max_acceleration * radius);
  double slowest = l.max_speed;
  for (Time t{0}; t < flight.duration(); t += kMs) {
    const Motion m = flight.at(t);
    if (distance_to_line(m.world_from_body.translation(), {{10, 0, 0}, {10, 1e-3, 0}}) > 0.3) {
      continue;
    }
    slowest = std::min(slowest, m.velocity_world.norm());
  }
  // smoothing averages the direction of the velocity over the arc: the speed is reduced by up to
  // the cosine of half the arc's angle
  EXPECT_LE(slowest, arc_speed * 1.02);
  EXPECT_GE(slowest, arc_speed * std::cos(pi / 4.0));
}

TEST(SplineFlight, DurationIsKeptByLoopingOrStoppingEarly) {
  FlightConfig config;
  for (const double seconds : {6.0, 10.0, 60.0, 200.0}) {
    config.duration_s = seconds;
    const SplineFlight flight(crooked(), config, "test");
    EXPECT_EQ(flight.duration(), from_seconds(seconds));
    EXPECT_NEAR(flight.at(flight.duration()).velocity_world.norm(), 0.0, 1e-11);
    double most = 0.0;
    for (Time t{0}; t < flight.duration(); t += 5 * kMs) {
      most = std::max(most, distance_to_line(flight.pose_at(t).translation(), crooked()));
    }
    EXPECT_LE(most, config.corner_m);
    // it moves until the end: it is not at rest 2 s before the hover
    const Time late = flight.duration() - from_seconds(config.hover_s + 2.0);
    EXPECT_GT((flight.pose_at(late).translation() - flight.pose_at(flight.duration()).translation())
                  .norm(),
              0.1);
  }
}

TEST(SplineFlight, AClosedLineIsFlownRoundWithoutAStopAtTheSeam) {
  FlightConfig config;
  config.duration_s = 60.0;
  const std::vector<Vector3d> square{{3, 0, 1}, {6, 0, 1}, {6, 6, 1},
                                     {0, 6, 1}, {0, 0, 1}, {3, 0, 1}};
  const SplineFlight flight(square, config, "test");
  int passes = 0;
  for (Time t = from_seconds(4.0); t < flight.duration() - from_seconds(4.0); t += kMs) {
    const Motion m = flight.at(t);
    ASSERT_GT(m.velocity_world.norm(), 0.3);
    const double x0 = m.world_from_body.translation().x() - 3.0;
    const double x1 = flight.pose_at(t + kMs).translation().x() - 3.0;
    if (m.world_from_body.translation().y() < 1.0 && x0 < 0.0 && x1 >= 0.0) ++passes;
  }
  EXPECT_GE(passes, 2);
}

TEST(SplineFlight, HeadingAlongThePathLooksWhereTheBodyGoes) {
  const std::vector<Vector3d> line{{0, 0, 0}, {10, 0, 0}, {10, 10, 0}};
  const SplineFlight flight(line, {}, "test");
  int checked = 0;
  for (Time t{0}; t < flight.duration(); t += kMs) {
    const Motion m = flight.at(t);
    const Vector3d p = m.world_from_body.translation();
    if ((p - line[1]).norm() < 1.5 || m.velocity_world.norm() < 0.5) continue;
    ASSERT_GT(m.velocity_world.normalized().dot(m.world_from_body.linear().col(0)),
              std::cos(limits_of(FlightStyle::kBrisk).max_tilt));
    ASSERT_NEAR(yaw_of(m.world_from_body), p.x() < 9.0 ? 0.0 : pi / 2.0, 1e-9);
    ++checked;
  }
  EXPECT_GT(checked, 3000);
}

TEST(SplineFlight, FixedHeadingStaysFixed) {
  FlightConfig config;
  config.heading = {.mode = HeadingMode::kFixed, .yaw = -2.0};
  const SplineFlight flight(crooked(), config, "test");
  for (Time t{0}; t < flight.duration(); t += 11 * kMs) {
    ASSERT_NEAR(yaw_of(flight.pose_at(t)), -2.0, 1e-9);
  }
}

TEST(SplineFlight, SweepReachesItsAmplitudeBothWaysInSpiteOfSmoothing) {
  FlightConfig config;
  config.heading = {.mode = HeadingMode::kSweep, .amplitude = 0.5, .period_s = 2.5};
  const SplineFlight flight(std::vector<Vector3d>{{0, 0, 0}, {40, 0, 0}}, config, "test");
  double low = 0.0, high = 0.0;
  for (Time t{0}; t < flight.duration(); t += kMs) {
    low = std::min(low, yaw_of(flight.pose_at(t)));
    high = std::max(high, yaw_of(flight.pose_at(t)));
  }
  EXPECT_NEAR(high, 0.5, 1e-3);
  EXPECT_NEAR(low, -0.5, 1e-3);
}

TEST(SplineFlight, OnAnOpenLineTheBodyStopsAndTurnsBeforeItFliesBack) {
  FlightConfig config;
  config.duration_s = 30.0;
  const SplineFlight flight(std::vector<Vector3d>{{0, 0, 1}, {8, 0, 1}}, config, "test");
  bool came_back = false;
  for (Time t{0}; t < flight.duration(); t += kMs) {
    const Motion m = flight.at(t);
    if (m.velocity_world.norm() < 1.0) continue;
    came_back = came_back || m.velocity_world.x() < 0.0;
    ASSERT_GT(m.velocity_world.normalized().dot(m.world_from_body.linear().col(0)), 0.5);
  }
  EXPECT_TRUE(came_back);
}

TEST(SplineFlight, AVerticalClimbKeepsItsHeading) {
  const std::vector<Vector3d> line{{0, 0, 0}, {0, 5, 0}, {0, 5, 4}, {0, 9, 4}};
  const SplineFlight flight(line, {}, "test");
  for (Time t{0}; t < flight.duration(); t += kMs) {
    ASSERT_NEAR(yaw_of(flight.pose_at(t)), pi / 2.0, 1e-9);
  }
}

TEST(SplineFlight, EqualInputGivesEqualMotionToTheBit) {
  const SplineFlight a(crooked(), {}, "test");
  const SplineFlight b(crooked(), {}, "test");
  for (Time t = a.duration(); t > Time{0}; t -= 13 * kMs) {
    ASSERT_TRUE(a.pose_at(t).matrix() == b.pose_at(t).matrix());
  }
}

TEST(SplineFlight, RefusesOneWaypointAndRepeatedOnes) {
  EXPECT_THAT(error_of({{1, 2, 3}}, {}), HasSubstr("here.yaml: has 1 waypoint"));
  EXPECT_THAT(error_of({}, {}), HasSubstr("has 0 waypoint"));
  EXPECT_THAT(error_of({{0, 0, 0}, {1, 2, 3}, {1, 2, 3}}, {}),
              HasSubstr("waypoint 3 repeats the previous one: (1, 2, 3)"));
}

TEST(SplineFlight, RefusesASweepThatTheYawRateForbidsAndADurationThatIsAllHover) {
  FlightConfig config;
  config.heading = {.mode = HeadingMode::kSweep, .amplitude = 1.0, .period_s = 2.0};
  EXPECT_THAT(error_of(crooked(), config), HasSubstr("limit of 1.50 rad/s"));
  config.heading.period_s = 0.1;
  EXPECT_THAT(error_of(crooked(), config), HasSubstr("heading's sweep"));
  FlightConfig brief;
  brief.duration_s = 2.0;
  EXPECT_THAT(error_of(crooked(), brief), HasSubstr("duration_s 2 leaves no time to move"));
}

}  // namespace
}  // namespace lidarena::flight
