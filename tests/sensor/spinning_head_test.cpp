// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/sensor/spinning_head.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <numbers>

#include "lidarena/base/error.hpp"
#include "lidarena/sensor/sensor_config.hpp"
#include "tests/sensor/flights.hpp"
#include "tests/sensor/shipped.hpp"
#include "tests/temporary_folder.hpp"

namespace lidarena::sensor {
namespace {

using testing::degrees;
using ::testing::HasSubstr;
using testing::radians;

namespace fs = std::filesystem;

std::vector<Beam> scan_of(const std::string& sensor) {
  std::vector<Beam> beams;
  make_pattern(load_sensor(kConfigs / (sensor + ".yaml")))->beams(3, beams);
  return beams;
}

double elevation_deg(const Beam& beam) {
  return degrees(std::asin(static_cast<double>(beam.direction.z())));
}
double azimuth_deg(const Beam& beam) {
  return degrees(std::atan2(beam.direction.y(), beam.direction.x()));
}
/// Difference of two angles, -180..180.
double angle_difference(double a_deg, double b_deg) { return std::remainder(a_deg - b_deg, 360.0); }

TEST(Vlp16, FiresItsLasersInTheMakersOrderAndTimes) {
  const auto beams = scan_of("velodyne_vlp16");
  ASSERT_EQ(beams.size(), 1808U * 16U);
  const double order[] = {-15, 1, -13, 3, -11, 5, -9, 7, -7, 9, -5, 11, -3, 13, -1, 15};
  for (std::size_t i = 0; i < beams.size(); ++i) {
    const std::size_t round = i / 16;
    const std::size_t laser = i % 16;
    const double us = 55.296 * static_cast<double>(round) + 2.304 * static_cast<double>(laser);
    ASSERT_NEAR(elevation_deg(beams[i]), order[laser], 1e-5);
    ASSERT_EQ(beams[i].ring, static_cast<int>(order[laser] + 15) / 2);
    ASSERT_NEAR(beams[i].dt_ns, 1e3 * us, 0.5);
    // The head rotates while it fires: 36 deg in 10 ms, clockwise from x.
    ASSERT_NEAR(angle_difference(azimuth_deg(beams[i]), -360.0 * us / 1e5), 0.0, 2e-5);
  }
  EXPECT_LT(beams.back().dt_ns, 100'000'000);
  EXPECT_NEAR(beams.front().origin.z(), 0.0112,
              1e-9);  // the lowest beam starts at the highest point
}

TEST(Os164, HasSixtyFourRowsInFourPixelColumns) {
  const auto beams = scan_of("ouster_os1_64");
  ASSERT_EQ(beams.size(), 1024U * 64U);
  const double clockwise_deg[] = {3.164, 1.055, -1.055, -3.164};
  for (std::size_t i = 0; i < beams.size(); ++i) {
    const auto row = static_cast<int>(i % 64);
    const auto column = static_cast<int>(i / 64);
    const double encoder = 360.0 * (1.0 - column / 1024.0);
    ASSERT_EQ(beams[i].ring, row);
    ASSERT_NEAR(beams[i].dt_ns, 97'656.25 * column, 0.51);
    ASSERT_NEAR(elevation_deg(beams[i]), 16.611 - 0.5273 * row, 1e-4);
    ASSERT_NEAR(angle_difference(azimuth_deg(beams[i]), encoder - clockwise_deg[row % 4]), 0.0,
                2e-5);
    ASSERT_NEAR(beams[i].origin.norm(), 0.015806, 1e-8);
    ASSERT_NEAR(
        angle_difference(degrees(std::atan2(beams[i].origin.y(), beams[i].origin.x())), encoder),
        0.0, 2e-5);
  }
  EXPECT_NEAR(elevation_deg(beams[63]), -16.61, 0.005);
}

TEST(SpinningHead, TurnsEitherWayFromWhereItStarts) {
  SpinningHead table;
  table.clockwise = false;
  table.start_azimuth_deg = 30.0;
  table.beams.resize(1);
  table.beams[0].elevation_deg = 10.0;
  table.beams[0].azimuth_offset_deg = 5.0;
  const SpinningHeadPattern pattern(table, 4, 20.0, "test");
  std::vector<Beam> beams;
  pattern.beams(0, beams);
  EXPECT_EQ(pattern.period(), std::chrono::milliseconds(50));
  ASSERT_EQ(beams.size(), 4U);
  for (int i = 0; i < 4; ++i) {
    EXPECT_NEAR(angle_difference(azimuth_deg(beams[static_cast<std::size_t>(i)]), 35.0 + 90.0 * i),
                0.0, 1e-5);
    EXPECT_EQ(beams[static_cast<std::size_t>(i)].dt_ns, 12'500'000 * i);
  }
}

/// The error message when loading a sensor with this table and these further lines.
std::string table_failure(const std::string& table, const std::string& sensor = "columns: 100\n") {
  const TemporaryFolder folder;
  folder.write("table_under_test.yaml", table);
  try {
    load_sensor(folder.write("table_sensor.yaml",
                             "model: beam_table\npattern_file: table_under_test.yaml\n" + sensor));
  } catch (const InputError& error) {
    return error.what();
  }
  return "no failure";
}

TEST(SpinningHead, ErrorsNameTheFileAndTheLine) {
  const std::string good = "beams:\n  - {elevation_deg: 1}\n";
  EXPECT_EQ(table_failure(good), "no failure");
  EXPECT_THAT(table_failure(good + "  - {elevation_deg: .nan}\n"),
              AllOf(HasSubstr("table_under_test.yaml:3"), HasSubstr("finite")));
  EXPECT_THAT(table_failure(good + "  - {elevation_deg: 91}\n"),
              AllOf(HasSubstr("table_under_test.yaml:3"), HasSubstr("90")));
  EXPECT_THAT(table_failure(good + "  - {elevation_dg: 1}\n"),
              AllOf(HasSubstr("table_under_test.yaml:3"), HasSubstr("elevation_deg")));
  EXPECT_THAT(table_failure(good + "  - {dt_us: 1}\n"),
              AllOf(HasSubstr("table_under_test.yaml:3"), HasSubstr("elevation_deg")));
  EXPECT_THAT(table_failure(good + "  - 7\n"), HasSubstr("table_under_test.yaml:3"));
  EXPECT_THAT(table_failure("clockwise: true\n"),
              AllOf(HasSubstr("table_under_test.yaml"), HasSubstr("no beams")));
  EXPECT_THAT(table_failure(""), HasSubstr("no beams"));
  EXPECT_THAT(table_failure("beams: [\n"), HasSubstr("table_under_test.yaml"));
  EXPECT_THAT(table_failure("beams:\n  - {elevation_deg: 1, dt_us: 1000}\n"),
              HasSubstr("column ends"));
  EXPECT_THAT(table_failure("column_period_us: 1001\n" + good),
              HasSubstr("longer than a revolution"));
  EXPECT_THAT(table_failure(good, ""), HasSubstr("set columns"));
  EXPECT_THAT(table_failure(good, "columns: 2000000000\n"), HasSubstr("too many columns"));
  EXPECT_THAT(table_failure(good, "columns: 100\nrow_rate_hz: 5\n"),
              HasSubstr("remove row_rate_hz"));
}

TEST(SpinningHead, TravelsWithTheSensorsConfiguration) {
  const SensorConfig sensor = load_sensor(kConfigs / "velodyne_vlp16.yaml");
  EXPECT_TRUE(sensor.pattern_file.empty());
  ASSERT_TRUE(sensor.beam_table.has_value());
  EXPECT_EQ(sensor.beam_table->beams.size(), 16U);
}

}  // namespace
}  // namespace lidarena::sensor
