// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/sensor/lidar_motion.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "lidarena/flight/flight_config.hpp"
#include "lidarena/flight/spline_flight.hpp"
#include "tests/sensor/flights.hpp"

namespace lidarena::sensor {
namespace {

using Eigen::Vector3d;
using namespace testing;

constexpr std::int32_t kScan = 99'995'000;  // ns, last shot of a Mid-360's scan
const Pose kTiltedMount = tilted_pose({0.1, 0.05, 0.1}, 0.2, -0.1, 0.4);

struct Worst {
  double position = 0.0;  ///< m
  double at_100_m = 0.0;  ///< m, of a point at 100 m, in the worst direction
};

/// Largest difference between the motion of scans 0, 1, ... and the flight itself at 777 instants
/// of each.
Worst worst_error(const flight::Flight& flight, int scans) {
  Worst worst;
  for (int scan = 0; scan < scans; ++scan) {
    const Time stamp = scan * std::chrono::milliseconds(100);
    const LidarMotion motion(flight, kTiltedMount, stamp, kScan, true);
    for (int i = 0; i <= 776; ++i) {
      const std::int32_t dt = kScan / 776 * i;
      const Pose exact = flight.pose_at(stamp + Time{dt}) * kTiltedMount;
      const Pose cubic = motion.at(dt);
      const double position = (cubic.translation() - exact.translation()).norm();
      const double rotation = (cubic.linear() - exact.linear()).norm();
      worst.position = std::max(worst.position, position);
      worst.at_100_m = std::max(worst.at_100_m, position + 100.0 * rotation);
    }
  }
  return worst;
}

/// At rest until `start`, then constant velocity and rotation rate: a jump in velocity.
class JoltedFlight : public flight::Flight {
 public:
  explicit JoltedFlight(double start) : start_(start) {}
  flight::Motion at(Time t) const override {
    const double s = std::max(0.0, to_seconds(t) - start_);
    flight::Motion motion;
    motion.world_from_body = tilted_pose({3.0 * s, 0, -s}, 0.5 * s, 0, 2.0 * s);
    return motion;
  }
  Time duration() const override { return std::chrono::seconds(10); }

 private:
  double start_;
};

TEST(LidarMotion, FollowsASmoothFlightWithoutAskingItForEveryShot) {
  const SwingingFlight flight(10.0);
  const Worst worst = worst_error(flight, 20);
  EXPECT_LT(worst.position, 1e-9);
  EXPECT_LT(worst.at_100_m, 1e-7);
  EXPECT_EQ(LidarMotion(flight, kTiltedMount, Time{0}, kScan, true).exact_share(), 0.0);
}

TEST(LidarMotion, FollowsAFastQuadrotor) {
  flight::FlightConfig config;
  config.style = flight::FlightStyle::kAggressive;
  const std::vector<Vector3d> tour{{0, 0, 1}, {4, 0, 2}, {4, 3, 1}, {0, 3, 2}, {0, 0, 1}};
  const flight::SplineFlight flight(tour, config, "test");
  const int scans = static_cast<int>(to_seconds(flight.duration()) * 10.0) - 1;
  const Worst worst = worst_error(flight, std::min(scans, 60));
  RecordProperty("worst_at_100_m", std::to_string(worst.at_100_m));
  EXPECT_LT(worst.at_100_m, 1e-6);
}

TEST(LidarMotion, AsksTheFlightItselfWhereItJolts) {
  for (const double start : {0.0123, 0.05, 0.0507, 0.15, 0.19995}) {
    const JoltedFlight flight(start);
    EXPECT_LT(worst_error(flight, 3).at_100_m, 1e-6) << start;
    const auto scan = static_cast<int>(start * 10.0);
    const LidarMotion motion(flight, kTiltedMount, scan * std::chrono::milliseconds(100), kScan,
                             true);
    EXPECT_GT(motion.exact_share(), 0.0) << start;
    EXPECT_LT(motion.exact_share(), 0.1) << start;
  }
}

TEST(LidarMotion, AShotAfterTheLastOneAnnouncedHasItsPose) {
  const SwingingFlight flight(10.0);
  const LidarMotion motion(flight, kTiltedMount, Time{0}, 1000, true);
  const std::int32_t late = 50'000'000;
  EXPECT_EQ(motion.at(late).matrix(), (flight.pose_at(Time{late}) * kTiltedMount).matrix());
}

TEST(LidarMotion, AFrozenScanStaysWhereItBegan) {
  const SwingingFlight flight(10.0);
  const Time stamp = std::chrono::milliseconds(700);
  const LidarMotion motion(flight, kTiltedMount, stamp, kScan, false);
  const Pose expected = flight.pose_at(stamp) * kTiltedMount;
  EXPECT_EQ(motion.at(0).matrix(), expected.matrix());
  EXPECT_EQ(motion.at(kScan).matrix(), expected.matrix());
}

}  // namespace
}  // namespace lidarena::sensor
