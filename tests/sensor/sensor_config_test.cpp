// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/sensor/sensor_config.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "lidarena/base/config_json.hpp"
#include "lidarena/base/error.hpp"
#include "tests/sensor/shipped.hpp"
#include "tests/temporary_folder.hpp"

namespace lidarena::sensor {
namespace {

using ::testing::HasSubstr;

namespace fs = std::filesystem;

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

/// The sensor of `yaml`, in a folder of its own, with the shipped sensors as bases.
SensorConfig variant(const std::string& yaml) {
  const TemporaryFolder folder;
  return load_sensor(folder.write("variant.yaml", yaml), kConfigs);
}

TEST(SensorConfig, AVariantStatesOnlyWhatDiffersFromItsBase) {
  Json expected = to_json(load_sensor(kConfigs / "livox_mid360.yaml"));
  EXPECT_EQ(to_json(variant("base: livox_mid360\nname: livox_mid360\n")), expected);

  const SensorConfig own = variant(
      "base: livox_mid360\n"
      "rate_hz: 20\n"
      "noise: {signal: {range_at_10_m: 30}}\n"
      "imu:\n"
      "  rate_hz: 400\n"
      "  vibration: [{frequency_hz: 90}]\n"
      "facts: {fov: {elevation_max_deg: 50}}\n");
  expected["name"] = "variant";
  expected["rate_hz"] = 20.0;
  expected["noise"]["signal"]["range_at_10_m"] = 30.0;
  expected["imu"]["rate_hz"] = 400.0;
  expected["imu"]["vibration"] = to_json(own)["imu"]["vibration"];
  expected["facts"]["fov"]["elevation_max_deg"] = 50.0;
  EXPECT_EQ(to_json(own), expected) << "all else, within the maps too, is the base's";
  ASSERT_EQ(own.imu->vibration.size(), 1U);
  EXPECT_EQ(own.imu->vibration.front().frequency_hz, 90.0);
  EXPECT_FALSE(variant("base: livox_mid360\nimu: null\n").imu.has_value());
}

TEST(SensorConfig, SettingOneKeyOfTheImuLeavesItsOthers) {
  SensorConfig sensor = load_sensor(kConfigs / "livox_mid360.yaml");
  Json expected = to_json(sensor);
  set_field(sensor, "imu.rate_hz=100");
  expected["imu"]["rate_hz"] = 100.0;
  EXPECT_EQ(to_json(sensor), expected);
}

TEST(SensorConfig, ABaseIsAFileBesideTheVariantOrAShippedSensorAndMayHaveABaseItself) {
  const TemporaryFolder folder;
  folder.write("one.yaml", "base: ouster_os0_128\ncolumns: 2048\nmax_range_m: 40\n");
  const auto two = folder.write("two.yaml", "base: one.yaml\nmax_range_m: 30\n");
  const auto three = folder.write("three.yaml", "base: two\n");
  const SensorConfig sensor = load_sensor(three, kConfigs);
  EXPECT_EQ(sensor.name, "three");
  EXPECT_EQ(sensor.columns, 2048);
  EXPECT_EQ(sensor.max_range_m, 30.0);
  EXPECT_EQ(sensor.min_range_m, 0.3);
  EXPECT_EQ(sensor_files(three, kConfigs).size(), 4U);
}

TEST(SensorConfig, ThePatternOfABaseIsReplacedAsAWhole) {
  const SensorConfig os0 = load_sensor(kConfigs / "ouster_os0_32.yaml");
  const SensorConfig same = variant("base: ouster_os0_32\ncolumns: 512\n");
  EXPECT_EQ(to_json(same)["beam_table"], to_json(os0)["beam_table"]);
  const SensorConfig other =
      variant("base: ouster_os0_32\nbeam_table: {beams: [{elevation_deg: 1}]}\n");
  EXPECT_EQ(other.beam_table->beams.size(), 1U);
  const SensorConfig exact = variant("base: ouster_os0_32\nmodel: ouster_os0_128\n");
  EXPECT_FALSE(exact.beam_table.has_value());
  EXPECT_EQ(make_pattern(exact)->beams_per_scan(), 128U * 1024U);
}

TEST(SensorConfig, ABaseThatIsMissingOrLeadsBackIsNamedWithItsPlace) {
  const auto failure_of = [](const std::string& yaml) {
    try {
      variant(yaml);
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string("no failure");
  };
  EXPECT_THAT(failure_of("rate_hz: 10\nbase: livox_mid361\n"),
              AllOf(HasSubstr("variant.yaml:2: base"), HasSubstr("'livox_mid361'"),
                    HasSubstr("did you mean 'livox_mid360'?")));
  EXPECT_THAT(failure_of("base: variant.yaml\n"),
              AllOf(HasSubstr("variant.yaml:1: base"), HasSubstr("leads back to")));
  EXPECT_THAT(failure_of("base: [livox_mid360]\n"), HasSubstr("variant.yaml:1: base"));
  EXPECT_THAT(failure_of("base: livox_mid360\nimu: 200\n"),
              AllOf(HasSubstr("variant.yaml:2: imu"), HasSubstr("a map")));
  EXPECT_THAT(failure_of("base: livox_mid360\nimu: {rate: 200}\n"),
              AllOf(HasSubstr("variant.yaml:2"), HasSubstr("rate_hz")));
  const TemporaryFolder folder;
  folder.write("a.yaml", "base: b.yaml\n");
  folder.write("b.yaml", "base: c.yaml\n");
  folder.write("c.yaml", "base: b.yaml\n");
  try {
    load_sensor(folder.path() / "a.yaml");
    FAIL() << "b and c are based on each other";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), AllOf(HasSubstr("c.yaml:1: base"), HasSubstr("b.yaml")));
  }
}

TEST(SensorConfig, ShippedVariantsDifferFromTheirSensorInWhatTheirNameSays) {
  const auto differences = [](const std::string& name, const std::string& other) {
    std::vector<std::string> keys;
    const Json a = to_json(load_sensor(kConfigs / (name + ".yaml"))).flatten();
    const Json b = to_json(load_sensor(kConfigs / (other + ".yaml"))).flatten();
    EXPECT_EQ(a.size(), b.size()) << name;
    for (const auto& [key, value] : a.items()) {
      if (key != "/name" && (!b.contains(key) || b.at(key) != value)) keys.push_back(key);
    }
    return keys;
  };
  using ::testing::UnorderedElementsAre;
  EXPECT_THAT(differences("ouster_os0_128_2048", "ouster_os0_128"),
              UnorderedElementsAre("/columns"));
  EXPECT_THAT(differences("ouster_os0_128_512x20", "ouster_os0_128"),
              UnorderedElementsAre("/columns", "/rate_hz"));
  EXPECT_THAT(differences("ouster_os0_128_range_noise", "ouster_os0_128"),
              UnorderedElementsAre("/columns", "/noise/angle_noise_deg", "/noise/dropouts",
                                   "/noise/range_step_m", "/noise/signal/range_at_10_m",
                                   "/noise/signal/range_at_80_m", "/noise/weak_signal_noise"));
  EXPECT_EQ(to_json(*load_sensor(kConfigs / "ouster_os0_128_same_imu.yaml").imu)["accel_range"],
            to_json(*load_sensor(kConfigs / "livox_mid360.yaml").imu)["accel_range"]);
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
  EXPECT_THAT(failure("imu: {gyro_nonlinearity: 0.01}\n"), HasSubstr("imu.gyro_range"));
  EXPECT_THAT(failure("imu: {broadband: {low_hz: 600}}\n"), HasSubstr("imu.broadband.low_hz"));
  EXPECT_THAT(failure("noise: {clock: {offset_s: -1}}\n"), HasSubstr("clock.offset_s"));
  EXPECT_THROW(load_sensor("no_such_file.yaml"), InputError);
}

}  // namespace
}  // namespace lidarena::sensor
