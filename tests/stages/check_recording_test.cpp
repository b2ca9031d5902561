// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/stages/check_recording.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "lidarena/stages/simulate_dataset.hpp"
#include "tests/temporary_folder.hpp"

namespace lidarena::stages {
namespace {

using evaluation::Finding;
using evaluation::Severity;
using ::testing::Contains;
using ::testing::IsEmpty;

const std::filesystem::path kShipped = LIDARENA_SOURCE_DIR "/configs";

/// The findings of a simulated recording, without notes.
std::vector<Finding> findings_of(const std::string& flight, const std::string& sensor,
                                 const std::vector<std::string>& set, double seconds = 8.0) {
  const TemporaryFolder folder;
  SimulateRequest request;
  request.world = kShipped / "worlds" / (flight.starts_with("cave") ? "cave.yaml" : "house.yaml");
  request.flight = kShipped / "flights" / (flight + ".yaml");
  request.sensors = {kShipped / "sensors" / (sensor + ".yaml")};
  request.shipped_sensors = kShipped / "sensors";
  request.set = set;
  request.seconds = seconds;
  request.hits = false;
  request.data = false;  // simulated while it is read
  LogSink log;
  const Parallel parallel(2);
  simulate_dataset(request, folder.path() / "data", parallel, log);
  std::vector<Finding> found = check_recording({folder.path() / "data"}, parallel, log).findings;
  std::erase_if(found, [](const Finding& f) { return f.severity == Severity::kNote; });
  return found;
}

std::vector<std::string> keys_of(const std::vector<Finding>& findings) {
  std::vector<std::string> keys;
  for (const Finding& finding : findings) keys.push_back(finding.key);
  return keys;
}

const Finding& finding(const std::vector<Finding>& findings, const std::string& key) {
  return *std::ranges::find(findings, key, &Finding::key);
}

TEST(CheckRecording, ThreeCleanRecordingsGiveNoFinding) {
  EXPECT_THAT(keys_of(findings_of("house", "livox_mid360", {})), IsEmpty());
  EXPECT_THAT(keys_of(findings_of("cave", "livox_mid360", {})), IsEmpty());
  EXPECT_THAT(keys_of(findings_of("house", "ouster_os0_32", {})), IsEmpty());
}

TEST(CheckRecording, AMountingThatIsStatedWrongIsFoundToATenthOfADegree) {
  // 2 deg about (1, -1, 1), of an IMU that is parallel to its LiDAR.
  const auto found = findings_of(
      "house_aggressive", "livox_mid360",
      {"sensor.told.lidar_from_imu=[0.0110, 0.02329, -0.04412, 0.010076, -0.010076, 0.010076, "
       "0.999848]"},
      20.0);
  ASSERT_THAT(keys_of(found), Contains("imu_mounting"));
  EXPECT_NEAR(finding(found, "imu_mounting").value, 2.0, 0.3);
}

TEST(CheckRecording, LateStampsAreFoundToAMillisecond) {
  const auto found = findings_of("house_aggressive", "livox_mid360", {"imu.delay_s=0.02"});
  ASSERT_THAT(keys_of(found), Contains("imu_delay"));
  EXPECT_NEAR(finding(found, "imu_delay").value, 0.02, 0.001);
}

TEST(CheckRecording, AClockThatDriftsIsFound) {
  // 1,000 ppm over 20 s: the halves lie 10 ms apart.
  const auto found = findings_of("house_aggressive", "livox_mid360",
                                 {"sensor.noise.clock={drift: 0.001, imu_shares: false}"}, 20.0);
  ASSERT_THAT(keys_of(found), Contains("clock_drift"));
  EXPECT_NEAR(finding(found, "clock_drift").value, -0.01, 0.002);
}

TEST(CheckRecording, AnImuThatClipsIsFoundAndOnePeakIsNot) {
  const auto found = findings_of("house_aggressive", "livox_mid360", {"imu.gyro_range=3"});
  ASSERT_THAT(keys_of(found), Contains("imu_saturated"));
  EXPECT_NEAR(finding(found, "imu_saturated").value, 3.0, 1e-9);
  const auto rounded = findings_of("house_aggressive", "livox_mid360",
                                   {"imu.gyro_resolution=0.05", "imu.accel_resolution=0.2"});
  EXPECT_THAT(keys_of(rounded), ::testing::Not(Contains("imu_saturated")))
      << "coarse steps have flat peaks";
}

TEST(CheckRecording, AStartInMotionIsFound) {
  EXPECT_THAT(keys_of(findings_of("house_aggressive", "livox_mid360", {"flight.begin_s=2"})),
              Contains("start_in_motion"));
}

TEST(CheckRecording, LostSamplesAreFound) {
  EXPECT_THAT(keys_of(findings_of("house", "livox_mid360", {"imu.lost_share=0.05"}, 20.0)),
              Contains("imu_gap"));
}

TEST(CheckRecording, StampsThatJitterAreFound) {
  EXPECT_THAT(keys_of(findings_of("house", "livox_mid360", {"imu.stamp_jitter_s=0.002"})),
              Contains("imu_jitter"));
}

TEST(CheckRecording, ASlowImuAndABiasAreFound) {
  const auto found =
      findings_of("house", "livox_mid360", {"imu.rate_hz=50", "imu.gyro_turn_on_bias=0.1"});
  EXPECT_THAT(keys_of(found), Contains("imu_rate"));
  EXPECT_THAT(keys_of(found), Contains("gyro_bias"));
}

TEST(CheckRecording, ALineOfVibrationIsFoundAtItsFrequency) {
  const auto found = findings_of(
      "house", "livox_mid360",
      {"imu.vibration=[{frequency_hz: 70, accel_amplitude: [3, 0, 0], grows_with_thrust: false}]"});
  ASSERT_THAT(keys_of(found), Contains("vibration_line"));
  EXPECT_NEAR(finding(found, "vibration_line").value, 70.0, 0.5);
}

TEST(CheckRecording, SweepsWithoutTimesAreFound) {
  EXPECT_THAT(keys_of(findings_of("house", "livox_mid360", {"sensor.mode=frozen_unstamped"})),
              Contains("no_point_times"));
}

}  // namespace
}  // namespace lidarena::stages
