// SPDX-License-Identifier: BSD-3-Clause
// Calls `lidarena check`, and `lidarena evaluate` with a map without a mesh.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/system/command_line.hpp"

namespace lidarena::testing {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;

class Check : public Cli {
 protected:
  /// Simulates 4 s of an OS0 in the test room as one file; returns it.
  std::string recording() {
    const std::string room = write("room.obj", room_obj());
    const std::string flight = write("flight.yaml", kRoomFlight);
    const Outcome simulated = call("simulate --world " + room + " --flight " + flight +
                                   " --sensor ouster_os0_32 --seconds 4 --out " + path("data"));
    EXPECT_EQ(simulated.exit_code, 0) << simulated.err;
    return path("data/data.mcap");
  }
};

TEST_F(Check, ACleanRecordingHasNoFaultAndACutOneHas) {
  const std::string file = recording();
  const Outcome clean = call("check " + file);
  EXPECT_EQ(clean.exit_code, 0) << clean.out << clean.err;
  EXPECT_THAT(clean.out, HasSubstr("0 faults, 0 warnings"));
  const std::string cut = write("cut.mcap", content(file).substr(0, fs::file_size(file) / 2));
  const Outcome broken = call("check --json " + cut);
  EXPECT_EQ(broken.exit_code, 1) << broken.err;
  const json first = json::parse(broken.out).at("findings").at(0);
  EXPECT_EQ(first.at("severity"), "fault");
  EXPECT_EQ(first.at("key"), "damaged");
}

TEST_F(Check, ARunOnACutRecordingUsesWhatIsWholeAndExitsWith1) {
  const std::string file = recording();
  const std::string cut = write("cut.mcap", content(file).substr(0, fs::file_size(file) / 2));
  const Outcome run = call("run kiss_icp " + cut + " --out " + path("run"));
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_THAT(run.err, HasSubstr("is cut off after"));
  EXPECT_TRUE(fs::exists(path("run/trajectory.tum")));
  EXPECT_THAT(json::parse(content(path("run/manifest.json"))).at("recording_ended").dump(),
              HasSubstr("is cut off after"));
}

TEST_F(Check, AMapIsScoredAgainstACloudAndByItself) {
  std::string near =
      "ply\nformat ascii 1.0\nelement vertex 400\nproperty double x\nproperty double "
      "y\nproperty double z\nend_header\n";
  std::string far = near;
  for (int i = 0; i < 20; ++i) {
    for (int k = 0; k < 20; ++k) {
      const std::string xy =
          std::to_string(500'000.0 + 0.03 * i) + " " + std::to_string(5'400'000.0 + 0.03 * k);
      near += xy + " 0\n";
      far += xy + " 0.02\n";
    }
  }
  const std::string map = write("map.ply", far), reference = write("reference.ply", near);
  const Outcome both = call("evaluate --json --map " + map + " --reference " + reference);
  ASSERT_EQ(both.exit_code, 0) << both.err;
  const json scores = json::parse(both.out);
  EXPECT_NEAR(scores.at("reference").at("accuracy_m").get<double>(), 0.02, 1e-4);
  EXPECT_NEAR(scores.at("reference").at("chamfer_m").get<double>(), 0.02, 1e-4);
  EXPECT_EQ(scores.at("reference").at("f_score_5cm"), 1.0);
  EXPECT_LT(scores.at("plane_thickness_m").get<double>(), 1e-3);
  EXPECT_THAT(call("evaluate --map " + map).out, HasSubstr("mean map entropy"));
}

}  // namespace
}  // namespace lidarena::testing
