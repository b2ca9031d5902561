// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/sensor/livox_csv.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <string>

#include "lidarena/base/error.hpp"
#include "lidarena/sensor/livox.hpp"
#include "lidarena/sensor/sensor_config.hpp"
#include "tests/sensor/flights.hpp"
#include "tests/temporary_folder.hpp"

namespace lidarena::sensor {
namespace {

using testing::degrees;
using ::testing::HasSubstr;
using testing::radians;

namespace fs = std::filesystem;

/// A temporary folder, one per process.
const TemporaryFolder& scratch() {
  static const TemporaryFolder folder;
  return folder;
}

fs::path written(const std::string& text) {
  return scratch().write("pattern_under_test.csv", text);
}

/// The first rows of the built-in Mid-360 in the format of the manufacturer's table, angles with
/// four decimals.
std::string mid360_table(std::uint64_t rows) {
  std::string csv = "Time/s,Azimuth/deg,Zenith/deg\r\n";
  for (std::uint64_t row = 0; row < rows; ++row) {
    const Eigen::Vector3d ray = livox_direction(livox_mid360(), row);
    char line[80];
    std::snprintf(line, sizeof(line), "%d,%.4f,%.4f\r\n", static_cast<int>(row),
                  degrees(std::atan2(ray.y(), ray.x())), degrees(std::acos(ray.z())));
    csv += line;
  }
  return csv;
}

TEST(LivoxCsv, TheMid360WrittenOutAndReadBackLooksTheSameWay) {
  const auto rays = read_livox_csv(written(mid360_table(40'000)));
  ASSERT_EQ(rays.size(), 40'000U);
  // Both angles are rounded to 1e-4 deg, and directions to single precision.
  const double rounding = std::hypot(radians(0.5e-4), radians(0.5e-4)) + 1e-7;
  const LivoxPattern model(livox_mid360(), 10.0, "test");
  const RayTablePattern table(rays, 200'000.0, 4, 10.0, "test");
  EXPECT_EQ(table.period(), model.period());
  ASSERT_EQ(table.beams_per_scan(), model.beams_per_scan());
  std::vector<Beam> expected;
  std::vector<Beam> found;
  for (const std::uint64_t scan : {1U, 0U}) {
    model.beams(scan, expected);
    table.beams(scan, found);
    for (std::size_t i = 0; i < found.size(); ++i) {
      ASSERT_LT((found[i].direction - expected[i].direction).norm(), rounding);
      ASSERT_EQ(found[i].dt_ns, expected[i].dt_ns);
      ASSERT_EQ(found[i].ring, expected[i].ring);
    }
  }
}

TEST(LivoxCsv, BeginsAnewWhenItEnds) {
  const auto rays =
      read_livox_csv(written("Time/s,Azimuth/deg,Zenith/deg\n0,0,90\n1,90,90\n2,0,0"));
  const RayTablePattern table(rays, 40.0, 2, 10.0, "test");  // 4 rows a scan of a table of 3
  std::vector<Beam> beams;
  table.beams(2, beams);  // rows 8 to 11, which are 2, 0, 1, 2
  ASSERT_EQ(beams.size(), 4U);
  EXPECT_LT((beams[0].direction - Eigen::Vector3f::UnitZ()).norm(), 1e-7F);
  EXPECT_LT((beams[1].direction - Eigen::Vector3f::UnitX()).norm(), 1e-7F);
  EXPECT_LT((beams[2].direction - Eigen::Vector3f::UnitY()).norm(), 1e-7F);
  EXPECT_EQ(beams[0].ring, 0);
  EXPECT_EQ(beams[2].ring, 1);
  EXPECT_EQ(beams[3].dt_ns, 75'000'000);
  EXPECT_EQ(table.repeats_after(), 3U);
}

TEST(LivoxCsv, TheHeaderSaysWhatTheColumnsHold) {
  const auto expected = read_livox_csv(written("Time/s,Azimuth/deg,Zenith/deg\n0,30,60\n"));
  for (const char* text : {"elevation [deg],azimuth [deg],time\n30,30,0\n",
                           "t,azimuth_rad,zenith_rad\n0,0.5235987755982988,1.0471975511965976\n"}) {
    EXPECT_LT((read_livox_csv(written(text)).at(0) - expected.at(0)).norm(), 1e-6F) << text;
  }
}

std::string csv_failure(const std::string& csv) {
  try {
    read_livox_csv(written(csv));
  } catch (const InputError& error) {
    return error.what();
  }
  return "no failure";
}

TEST(LivoxCsv, ErrorsNameTheFileAndTheLine) {
  EXPECT_EQ(csv_failure("Time/s,Azimuth/deg,Zenith/deg\n0, 1.5,\t88\n\n"), "no failure");
  const std::string good = "time,azimuth/deg,zenith/deg\n0,1,2\n";
  EXPECT_THAT(csv_failure(good + "1,nan,2\n"), HasSubstr("pattern_under_test.csv:3: an angle"));
  EXPECT_THAT(csv_failure(good + "1,inf,2\n"), HasSubstr("csv:3: an angle"));
  EXPECT_THAT(csv_failure(good + "1,361,2\n"), HasSubstr("csv:3: an angle"));
  EXPECT_THAT(csv_failure(good + "1,1,-0.1\n"), HasSubstr("csv:3: an angle"));
  EXPECT_THAT(csv_failure(good + "1,1,180.1\n"), HasSubstr("csv:3: an angle"));
  EXPECT_THAT(csv_failure(good + "1,1\n"), HasSubstr("csv:3: is not a row of three"));
  EXPECT_THAT(csv_failure(good + "1,1,2,3\n"), HasSubstr("csv:3: is not a row of three"));
  EXPECT_THAT(csv_failure(good + "1,1,2x\n"), HasSubstr("csv:3: is not a row of three"));
  EXPECT_THAT(csv_failure(good + "1,,2\n"), HasSubstr("csv:3: is not a row of three"));
  EXPECT_THAT(csv_failure(good + "a,b,c\n"), HasSubstr("csv:3: is not a row of three"));
  EXPECT_THAT(csv_failure("0,1,2\n"), HasSubstr("csv:1: is not a header"));
  EXPECT_THAT(csv_failure("time,azimuth,zenith\n"),
              HasSubstr("csv:1: the column 'azimuth' states"));
  EXPECT_THAT(csv_failure("time,azimuth/deg,zenith/deg\n"), HasSubstr("has no rows"));
  EXPECT_THAT(csv_failure(""), HasSubstr("has no rows"));
  EXPECT_THROW(read_livox_csv("no_such.csv"), InputError);
}

/// The error message when loading a sensor with these keys.
std::string sensor_failure(const std::string& yaml) {
  try {
    load_sensor(scratch().write("csv_sensor.yaml", "model: livox_csv\n" + yaml));
  } catch (const InputError& error) {
    return error.what();
  }
  return "no failure";
}

TEST(LivoxCsv, IsASensorsPatternOnceItsRowRateIsTold) {
  const fs::path table = written("Time/s,Azimuth/deg,Zenith/deg\n0,0,90\n1,90,90\n");
  const std::string file = "pattern_file: " + table.filename().string() + "\n";
  EXPECT_EQ(sensor_failure(file + "row_rate_hz: 1000\nlines: 2\n"), "no failure");
  EXPECT_THAT(sensor_failure(file), HasSubstr("set row_rate_hz"));
  EXPECT_THAT(sensor_failure("row_rate_hz: 1000\n"), HasSubstr("set pattern_file"));
  EXPECT_THAT(sensor_failure(file + "row_rate_hz: 1005\n"), HasSubstr("whole"));
  EXPECT_THAT(sensor_failure(file + "row_rate_hz: 1000\ncolumns: 5\n"),
              HasSubstr("remove columns"));
  EXPECT_THAT(sensor_failure("pattern_file: gone.csv\nrow_rate_hz: 1000\n"), HasSubstr("gone.csv"));
}

}  // namespace
}  // namespace lidarena::sensor
