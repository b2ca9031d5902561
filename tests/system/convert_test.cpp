// SPDX-License-Identifier: BSD-3-Clause
// Calls `lidarena convert`, and `lidarena simulate` with its output formats.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/system/command_line.hpp"

namespace lidarena::testing {
namespace {

using nlohmann::json;
using ::testing::AllOf;
using ::testing::HasSubstr;

class Convert : public Cli {
 protected:
  /// Simulates 1 s of the Mid-360 in the test room; returns the dataset's folder.
  std::string dataset(const std::string& options = "") {
    const std::string room = write("room.obj", room_obj());
    const std::string flight = write("flight.yaml", kRoomFlight);
    const Outcome simulated =
        call("simulate --world " + room + " --flight " + flight +
             " --sensor livox_mid360 --seconds 1 " + options + " --out " + path("data"));
    EXPECT_EQ(simulated.exit_code, 0) << simulated.err;
    return path("data");
  }
  json converted(const std::string& in, const std::string& out, const std::string& options = "") {
    const Outcome outcome = call("convert --json " + in + " " + out + " " + options);
    EXPECT_EQ(outcome.exit_code, 0) << in << " to " << out << "\n" << outcome.err;
    return outcome.exit_code == 0 ? json::parse(outcome.out) : json::object();
  }
  json info(const std::string& thing) {
    const Outcome outcome = call("info --json " + thing);
    EXPECT_EQ(outcome.exit_code, 0) << thing << "\n" << outcome.err;
    return outcome.exit_code == 0 ? json::parse(outcome.out) : json::object();
  }
};

TEST_F(Convert, ADatasetGoesThroughEveryFormatAndBackWithItsPoints) {
  const std::string data = dataset("--truth");
  const json points = info(data).at("topics").at("livox_mid360/points");
  ASSERT_GT(points.at("points").get<int>(), 100'000);

  const json bag = converted(data, path("one.bag"));
  EXPECT_EQ(bag.at("scans"), 10);
  EXPECT_EQ(bag.at("truth_scans"), 10);
  converted(path("one.bag"), path("two.mcap"));
  converted(path("two.mcap"), path("sweeps"), "--format pcd");
  converted(path("sweeps"), path("three"), "--format bag");
  for (const char* name : {"one.bag", "two.mcap", "sweeps", "three"}) {
    const json topics = info(path(name)).at("topics");
    EXPECT_EQ(topics.at("livox_mid360/points").at("points"), points.at("points")) << name;
    EXPECT_EQ(topics.at("livox_mid360/points").at("untimed_scans"), 0) << name;
    EXPECT_EQ(topics.at("livox_mid360/imu").at("messages"), 201) << name;
  }
}

TEST_F(Convert, WhatItWritesIsInputToSlam) {
  const std::string data = dataset();
  ASSERT_EQ(call("run kiss_icp " + data + " --out " + path("run")).exit_code, 0);
  for (const char* out : {"a.bag", "b.mcap"}) {
    converted(data, path(out), "--dialect driver");
    const Outcome ran =
        call("run --json kiss_icp " + path(out) + " --out " + path(std::string(out) + "_run"));
    ASSERT_EQ(ran.exit_code, 0) << ran.err;
    EXPECT_EQ(json::parse(ran.out).at("scans"), 10);
  }
}

TEST_F(Convert, SimulateWritesBagsInTheDriversLayout) {
  const std::string data = dataset("--format bag --dialect driver");
  EXPECT_TRUE(fs::exists(fs::path(data) / "data.bag"));
  EXPECT_FALSE(fs::exists(fs::path(data) / "data.mcap"));
  const Outcome ran = call("run --json fast_lio2 " + data + " --out " + path("run"));
  ASSERT_EQ(ran.exit_code, 0) << ran.err;
  EXPECT_EQ(json::parse(ran.out).at("scans"), 10);
}

TEST_F(Convert, WorldsCloudsAndTrajectories) {
  const std::string room = write("room.obj", room_obj());
  for (const char* out : {"room.ply", "room2.obj", "room.sdf"}) {
    EXPECT_EQ(converted(room, path(out)).at("triangles"), 36) << out;
  }
  if (LIDARENA_TEST_SDF) {
    EXPECT_EQ(converted(path("room.sdf"), path("again.ply")).at("triangles"), 36);
  }

  const std::string cloud =
      write("cloud.pcd",
            "VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 2\nHEIGHT 1\n"
            "POINTS 2\nDATA ascii\n1 2 3\n4 5 6\n");
  EXPECT_EQ(converted(cloud, path("cloud.ply")).at("points"), 2);
  EXPECT_EQ(converted(path("cloud.ply"), path("back.pcd")).at("kind"), "cloud");

  const std::string trajectory = write("a.tum", "1.5 1 2 3 0 0 0 1\n2.5 1 2 4 0 0 0 1\n");
  EXPECT_EQ(converted(trajectory, path("poses.txt")).at("poses"), 2);
  EXPECT_THAT(content(path("poses.txt")), HasSubstr("1 0 0 1 0 1 0 2 0 0 1 3"));
  EXPECT_THAT(content(path("poses.times.txt")), HasSubstr("1.500000000"));

  EXPECT_THAT(refusal("convert " + room + " " + path("room.stl")),
              AllOf(HasSubstr("room.stl"), HasSubstr(".ply")));
  EXPECT_THAT(refusal("convert " + cloud + " " + path("cloud.xyz")), HasSubstr(".pcd"));
}

}  // namespace
}  // namespace lidarena::testing
