// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/flight/make_flight.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "lidarena/base/error.hpp"
#include "lidarena/base/so3.hpp"
#include "lidarena/flight/replay_flight.hpp"
#include "tests/flight/flight_conformance.hpp"
#include "tests/flight/flight_scenes.hpp"
#include "tests/flight/tour_scenes.hpp"
#include "tests/temporary_folder.hpp"

namespace lidarena::flight {
namespace {

using testing::AllOf;
using testing::HasSubstr;

class MakeFlight : public testing::Test {
 protected:
  void SetUp() override {
    model_.name = "walls";
    model_.mesh = test_scenes::wall_with_door();
    model_.routes = {{{-2, 0, 1}, {2, 0, 1}}, {{-2, 0, 1}, {-2, 2, 1}, {2, 2, 1}}};
  }

  std::unique_ptr<Flight> make(const std::filesystem::path& file) const {
    LogSink log;
    return make_flight(file, model_, world::World(world::TriangleMesh(model_.mesh)), log);
  }
  std::string error_of(const std::string& name, const std::string& text) const {
    try {
      make(folder_.write(name, text));
    } catch (const InputError& e) {
      return e.what();
    }
    return "no error";
  }

  TemporaryFolder folder_;
  world::WorldModel model_;
};

TEST_F(MakeFlight, WaypointsAndStyleComeFromTheFile) {
  const auto flight = make(folder_.write("a.yaml", R"(
kind: waypoints
waypoints: [[-2, 0, 1], [2, 0, 1.5]]
style: gentle
limits: {max_speed: 0.5}
heading: {mode: fixed, yaw: 1.0}
duration_s: 9
)"));
  EXPECT_EQ(flight->duration(), std::chrono::seconds(9));
  EXPECT_NEAR(flight->pose_at(Time{0}).translation().x(), -2.0, 1e-12);
  const Eigen::Matrix3d turned = so3::exp(Eigen::Vector3d::UnitZ());
  EXPECT_NEAR((flight->pose_at(Time{0}).linear() - turned).norm(), 0.0, 1e-9);
  conformance::expect_lawful(*flight, 2);
}

TEST_F(MakeFlight, ARouteIsTheWorldsOwn) {
  const auto flight = make(folder_.write("a.yaml", "kind: route\n"));
  const Eigen::Vector3d end = flight->pose_at(flight->duration()).translation();
  EXPECT_NEAR((end - Eigen::Vector3d(2, 0, 1)).norm(), 0.0, 1e-12);
  EXPECT_THAT(error_of("b.yaml", "kind: route\nroute: 2\n"),
              HasSubstr("the world 'walls' has 2 route(s), but route 2 (from 0) is selected"));
}

TEST_F(MakeFlight, AFlightThroughAWallIsRefusedWithItsPlaceAndTime) {
  EXPECT_THAT(error_of("wall.yaml", "kind: route\nroute: 1\n"),
              AllOf(HasSubstr("wall.yaml: the flight comes within 0.2"),
                    HasSubstr("m of a surface at (-0."), HasSubstr(" s after its start"),
                    HasSubstr("clearance_m (0.3)")));
  EXPECT_THAT(error_of("wall.yaml", "kind: route\nroute: 1\nclearance_m: 0\n"),
              HasSubstr("the flight passes through a surface at (-0.0"));
}

TEST_F(MakeFlight, ReplaysATumFileWithNanosecondsIntact) {
  const std::string tum =
      "# t x y z qx qy qz qw\n"
      "1700000000.000000001 -2 0 1 0 0 0 1\n"
      "1700000000.250000003 -1 0 1 0 0 0 1\n"
      "\n"
      "1700000000.5 0 0 1 0 0 0.479425538604203 0.877582561890373\n"
      "1.700000001e+09 2 0 1 0 0 0.8414709848078965 0.5403023058681398\n";
  const auto bare = make(folder_.write("recorded.tum", tum));
  EXPECT_EQ(bare->duration(), Time{999'999'999});
  const Pose second = bare->pose_at(Time{250'000'002});
  EXPECT_NEAR(second.translation().x(), -1.0, 1e-12);
  const auto placed = make(folder_.write(
      "replay.yaml",
      "kind: replay\nreplay: recorded.tum\nworld_from_recording: [0, 0, 0.5, 0, 0, 0, 1]\n"));
  EXPECT_NEAR(placed->pose_at(Time{0}).translation().z(), 1.5, 1e-12);
  const Pose end = placed->pose_at(placed->duration());
  EXPECT_NEAR((end.linear() - so3::exp(2.0 * Eigen::Vector3d::UnitZ())).norm(), 0.0, 1e-12);
}

TEST_F(MakeFlight, BadRowsOfARecordingAreNamed) {
  EXPECT_THAT(error_of("a.tum", "0 0 0 1 0 0 0 1\n1 0 0\n"), HasSubstr("a.tum:2: is not a row"));
  EXPECT_THAT(error_of("a.tum", "x 0 0 1 0 0 0 1\n"), HasSubstr("a.tum:1: has no time"));
  EXPECT_THAT(error_of("a.tum", "1.2.3 0 0 1 0 0 0 1\n"), HasSubstr("a.tum:1: has no time"));
  EXPECT_THAT(error_of("a.tum", "0 0 0 1 0 0 0 3\n"), HasSubstr("a.tum:1: the quaternion"));
  EXPECT_THAT(error_of("a.tum", "0 0 0 1 0 0 0 1\n0 0 0 1 0 0 0 1\n"), HasSubstr("a.tum: pose 2"));
  EXPECT_THAT(error_of("a.tum", "0 0 0 1 0 0 0 1\n"), HasSubstr("a.tum: has 1 pose"));
  EXPECT_THAT(error_of("a.yaml", "kind: replay\nreplay: none.tum\n"),
              HasSubstr("none.tum: cannot be opened"));
  EXPECT_THAT(error_of("a.yaml", "kind: replay\n"), HasSubstr("the key 'replay' is missing"));
}

TEST_F(MakeFlight, BadConfigurationsAreNamedByFileLineAndKey) {
  EXPECT_THAT(error_of("a.yaml", "waypoints: [[0, 0, 1]]\n"), HasSubstr("has 1 waypoint"));
  EXPECT_THAT(error_of("a.yaml", "kind: waypoints\nwaypoints: [[-2, 0, 1], [-2, 0, 1]]\n"),
              HasSubstr("waypoint 2 repeats"));
  EXPECT_THAT(error_of("a.yaml", "kind: waypoints\nwaypoints: [[0, 0], [1, 1]]\n"),
              HasSubstr("a.yaml:2: waypoints[0]"));
  EXPECT_THAT(error_of("a.yaml", "kind: route\nlimits: {max_speed: 0}\n"),
              HasSubstr("a.yaml:2: limits.max_speed: 0 is out of range; it must be above 0"));
  EXPECT_THAT(error_of("a.yaml", "kind: route\nlimits: {max_acceleration: -1}\n"),
              HasSubstr("limits.max_acceleration"));
  EXPECT_THAT(error_of("a.yaml", "kind: route\nroute: -1\n"), HasSubstr("route: -1 is out of"));
  EXPECT_THAT(error_of("a.yaml", "kind: rout\n"), HasSubstr("use one of waypoints, route, replay"));
  EXPECT_THAT(error_of("a.yaml", "kind: route\nhover: 1\n"), HasSubstr("did you mean 'hover_s'?"));
  EXPECT_THAT(error_of("a.yaml", "kind: route\ncorner_m: 0\n"), HasSubstr("corner_m"));
}

TEST_F(MakeFlight, DynamicsAreOffByDefaultAndTakenFromTheFile) {
  const std::string path = "kind: route\n";
  const auto ideal = make(folder_.write("a.yaml", path));
  const auto flown = make(folder_.write("b.yaml", path + "dynamics: {}\n"));
  const auto heavy =
      make(folder_.write("c.yaml", path + "dynamics: {mass_kg: 2, motor_lag_s: 0.05}\n"));
  const auto apart = [&](const Flight& a, const Flight& b) {
    const Time middle = a.duration() / 2;
    return (a.pose_at(middle).translation() - b.pose_at(middle).translation()).norm();
  };
  EXPECT_GT(apart(*ideal, *flown), 1e-5);
  EXPECT_LT(apart(*ideal, *flown), 0.05);
  EXPECT_GT(apart(*flown, *heavy), 1e-5);
  EXPECT_THAT(error_of("a.yaml", path + "dynamics: {mass: 2}\n"),
              HasSubstr("unknown key 'mass'; valid keys: mass_kg, inertia"));
  EXPECT_THAT(error_of("a.yaml", path + "dynamics:\n  gusts: {gust_speed: -1}\n"),
              HasSubstr("a.yaml:3: dynamics.gusts.gust_speed: -1 is out of range"));
}

TEST_F(MakeFlight, BeginningLateItIsTheSameFlightFromThenOnAndInMotion) {
  const std::string route = "kind: route\nhover_s: 0.5\ndynamics: {gusts: {gust_speed: 0.3}}\n";
  const auto whole = make(folder_.write("a.yaml", route + "duration_s: 9.75\n"));
  const auto late = make(folder_.write("b.yaml", route + "duration_s: 8\nbegin_s: 1.25\n"));
  EXPECT_EQ(late->duration(), std::chrono::seconds(8)) << "of what is recorded";
  const Time begin = from_seconds(1.75);
  for (Time t{0}; t <= late->duration(); t += std::chrono::milliseconds(13)) {
    const Motion a = whole->at(t + begin);
    const Motion b = late->at(t);
    EXPECT_EQ(a.world_from_body.matrix(), b.world_from_body.matrix());
    EXPECT_EQ(a.acceleration_world, b.acceleration_world);
    EXPECT_EQ(late->pose_at(t).matrix(), whole->pose_at(t + begin).matrix());
  }
  EXPECT_GT(late->at(Time{0}).velocity_world.norm(), 0.3) << "a start in motion";
  conformance::expect_rest_outside(*late);
}

TEST_F(MakeFlight, AReplayBeginsLateAfterItsFirstPose) {
  folder_.write("a.tum", "5 0 0 1 0 0 0 1\n6 0 0 2 0 0 0 1\n7 0 0 4 0 0 0 1\n");
  const auto flight = make(folder_.write("a.yaml", "kind: replay\nreplay: a.tum\nbegin_s: 1\n"));
  EXPECT_EQ(flight->duration(), std::chrono::seconds(1));
  EXPECT_NEAR(flight->pose_at(Time{0}).translation().z(), 2.0, 1e-12);
  EXPECT_THAT(
      error_of("b.yaml", "kind: replay\nreplay: a.tum\nbegin_s: 2\n"),
      AllOf(HasSubstr("b.yaml: the recording begins 2 s after the start of a flight of 2 s"),
            HasSubstr("reduce begin_s")));
  EXPECT_THAT(error_of("b.yaml", "kind: route\nbegin_s: -1\n"),
              HasSubstr("b.yaml:2: begin_s: -1 is out of range"));
}

TEST_F(MakeFlight, ClearanceHoldsForThePathAsFlownNotAsPlanned) {
  const std::string path = "kind: route\n";
  make(folder_.write("a.yaml", path));  // the reference passes through the center of the door
  EXPECT_THAT(error_of("a.yaml", path + "dynamics: {gusts: {wind: [0, 5, 0]}}\n"),
              HasSubstr("m of a surface"));
}

TEST_F(MakeFlight, AnAutomaticTourIsPlannedInTheWorldAndTold) {
  struct Told : LogSink {
    void message(LogLevel, std::string_view text) override { all += std::string(text) + "\n"; }
    std::string all;
  } told;
  model_.mesh = test_scenes::two_rooms();
  const auto flight = make_flight(folder_.write("a.yaml", R"(
kind: auto
clearance_m: 0.4
corner_m: 0.1
duration_s: 40
tour: {voxel_size_m: 0.2, samples: 500, max_views: 50, start: [1, 2, 1.2]}
)"),
                                  model_, world::World(world::TriangleMesh(model_.mesh)), told);
  EXPECT_EQ(flight->duration(), std::chrono::seconds(40));
  EXPECT_NEAR((flight->pose_at(Time{0}).translation() - Eigen::Vector3d(1, 2, 1.2)).norm(), 0.0,
              1e-12);
  conformance::expect_lawful(*flight, 2);
  EXPECT_THAT(told.all, HasSubstr("a.yaml: a tour of "));
  EXPECT_THAT(told.all, HasSubstr(" % of what is visible from the "));
  EXPECT_THAT(error_of("b.yaml", "kind: auto\ntour: {coverage: 1.5}\n"),
              HasSubstr("b.yaml:2: tour.coverage: 1.5 is out of range"));
}

TEST_F(MakeFlight, AWorldWithoutRoutesSaysSo) {
  model_.routes.clear();
  EXPECT_THAT(error_of("a.yaml", "kind: route\n"), HasSubstr("has 0 route(s)"));
}

TEST(Recordings, ARealFlightIsReplayedThroughItsPoses) {
  const std::filesystem::path file = std::filesystem::path(LIDARENA_SHARED_DATA) /
                                     "trajectories/euroc_V1_02/stamped_groundtruth.txt";
  if (!std::filesystem::exists(file)) GTEST_SKIP() << "the EuRoC data is missing";
  world::WorldModel model;
  model.mesh = test_scenes::box({100, 100, 100}, {101, 101, 101});
  LogSink log;
  const auto flight = make_flight(file, model, world::World(world::TriangleMesh(model.mesh)), log);
  EXPECT_NEAR(to_seconds(flight->duration()), 83.5, 1.0);
  conformance::expect_lawful(*flight, 1);
}

}  // namespace
}  // namespace lidarena::flight
