// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/sensor/sensor_config.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "lidarena/base/config_json.hpp"
#include "lidarena/base/error.hpp"
#include "tests/temporary_folder.hpp"

namespace lidarena::sensor {
namespace {

using ::testing::HasSubstr;

namespace fs = std::filesystem;

const fs::path kConfigs = LIDARENA_SOURCE_DIR "/configs/sensors";

/// The error message when loading `yaml`.
std::string failure(const std::string& yaml) {
  const TemporaryFolder folder;
  try {
    load_sensor(folder.write("sensor_under_test.yaml", yaml));
  } catch (const InputError& error) {
    return error.what();
  }
  return "no failure";
}

TEST(SensorConfig, EveryFileThatShipsLoadsAndNamesItsSourceAndFieldOfView) {
  int files = 0;
  for (const auto& entry : fs::directory_iterator(kConfigs)) {
    if (entry.path().extension() != ".yaml") continue;
    const SensorConfig sensor = load_sensor(entry.path());
    EXPECT_EQ(sensor.name, entry.path().stem());
    EXPECT_FALSE(sensor.facts.source.empty());
    EXPECT_TRUE(sensor.facts.fov.has_value());
    ++files;
  }
  EXPECT_GE(files, 24);
}

TEST(SensorConfig, TheOusterFilesAreTheFiveModesOfTheMaker) {
  struct Mode {
    const char* file;
    std::size_t columns;
    double rate_hz;
  };
  for (const auto& [file, columns, rate_hz] :
       {Mode{"ouster_os0_128_512.yaml", 512, 10}, Mode{"ouster_os0_128.yaml", 1024, 10},
        Mode{"ouster_os0_128_2048.yaml", 2048, 10}, Mode{"ouster_os0_128_512x20.yaml", 512, 20},
        Mode{"ouster_os0_128_1024x20.yaml", 1024, 20}}) {
    const auto pattern = make_pattern(load_sensor(kConfigs / file));
    EXPECT_EQ(pattern->beams_per_scan(), 128 * columns);
    EXPECT_EQ(pattern->period(), from_seconds(1.0 / rate_hz));
  }
}

TEST(SensorConfig, ThePapersSensorsHaveItsRangesAndNoNoise) {
  const SensorConfig livox = load_sensor(kConfigs / "livox_mid360_paper.yaml");
  EXPECT_EQ(livox.max_range_m, 40.0);
  EXPECT_EQ(livox.range_noise_m, 0.0);
  EXPECT_EQ(livox.imu->gyro_noise_density, 0.0);
  const SensorConfig ouster = load_sensor(kConfigs / "ouster_os0_128_paper.yaml");
  EXPECT_EQ(ouster.max_range_m, 100.0);
  EXPECT_EQ(ouster.range_noise_m, 0.0);
  EXPECT_EQ(make_pattern(ouster)->beams_per_scan(), 262'144U);
}

TEST(SensorConfig, WhatIsSavedAsJsonLoadsAsTheSame) {
  for (const char* file : {"ouster_os0_128.yaml", "velodyne_vlp16.yaml", "livox_mid70.yaml"}) {
    const SensorConfig sensor = load_sensor(kConfigs / file);
    const Json json = to_json(sensor);
    SensorConfig again;
    read_config(ConfigNode::parse(json.dump(), "saved"), again);
    EXPECT_EQ(to_json(again), json);
    EXPECT_EQ(make_pattern(again)->beams_per_scan(), make_pattern(sensor)->beams_per_scan());
  }
}

TEST(SensorConfig, ErrorsNameTheFileThePlaceAndTheRemedy) {
  EXPECT_THAT(failure("model: livox_mid360\nmax_rnge_m: 3\n"),
              AllOf(HasSubstr("sensor_under_test.yaml:2"), HasSubstr("max_range_m")));
  EXPECT_THAT(failure("model: livox_mid361\n"),
              AllOf(HasSubstr("sensor_under_test.yaml:1"), HasSubstr("livox_mid360")));
  EXPECT_THAT(failure("mode: melting\n"), HasSubstr("frozen_unstamped"));
  EXPECT_THAT(failure("range_noise_m: -1\n"), HasSubstr("at least 0"));
  EXPECT_THAT(failure("imu: {rate_hz: 0}\n"), HasSubstr("imu.rate_hz"));
  EXPECT_THAT(failure("min_range_m: 5\nmax_range_m: 5\n"), HasSubstr("min_range_m"));
  EXPECT_THAT(failure("model: ouster_os0_128\n"), HasSubstr("2048"));
  EXPECT_THAT(failure("model: livox_mid40\ncolumns: 512\n"), HasSubstr("columns"));
  EXPECT_THAT(failure("rate_hz: 30\n"), HasSubstr("whole"));
  EXPECT_THAT(failure("facts: {fov: {azimuth_min_deg: 180}}\n"), HasSubstr("facts.fov"));
  EXPECT_THAT(failure("rate_hz: 0.1\n"), HasSubstr("at least 0.5"));
  EXPECT_THROW(load_sensor("no_such_file.yaml"), InputError);
}

}  // namespace
}  // namespace lidarena::sensor
