// SPDX-License-Identifier: BSD-3-Clause
// Laws that hold for every sensor in configs/sensors.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <set>

#include "lidarena/sensor/ouster.hpp"
#include "tests/sensor/flights.hpp"
#include "tests/sensor/shipped.hpp"
#include "tests/sensor/worlds.hpp"

namespace lidarena::sensor {
namespace {

using namespace testing;
using Eigen::Vector3d;

namespace fs = std::filesystem;

std::vector<std::string> shipped() {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(kConfigs)) {
    if (entry.path().extension() == ".yaml") names.push_back(entry.path().stem());
  }
  std::ranges::sort(names);
  return names;
}

SensorConfig shipped_sensor(const std::string& name) {
  return load_sensor(kConfigs / (name + ".yaml"));
}

double elevation_deg(const Eigen::Vector3f& direction) {
  return degrees(std::asin(std::clamp(static_cast<double>(direction.z()), -1.0, 1.0)));
}

class ShippedSensor : public ::testing::TestWithParam<std::string> {
 protected:
  const SensorConfig config_ = shipped_sensor(GetParam());
  const std::unique_ptr<ScanPattern> pattern_ = make_pattern(config_);
};

TEST_P(ShippedSensor, FiresUnitRaysInOrderOfTimeWithinItsPeriod) {
  for (const std::uint64_t index : {0U, 7U}) {
    std::vector<Beam> beams;
    pattern_->beams(index, beams);
    ASSERT_EQ(beams.size(), pattern_->beams_per_scan());
    std::set<int> rings;
    std::int32_t last = 0;
    for (const Beam& beam : beams) {
      ASSERT_NEAR(beam.direction.norm(), 1.0, 1e-6);
      ASSERT_GE(beam.dt_ns, last);
      last = beam.dt_ns;
      rings.insert(beam.ring);
    }
    EXPECT_LT(Time(last), pattern_->period());
    EXPECT_EQ(*rings.rbegin() + 1, static_cast<int>(rings.size())) << "rings without a gap";
  }
}

TEST_P(ShippedSensor, FillsTheFieldOfViewOfItsDataSheetAndNoMore) {
  // A unit's calibration differs from the nominal edges by up to about a degree; a Livox's outer
  // beams reach them in parts of the field only, and the innermost of a rosette is not sharp.
  constexpr double kMargin = 2.0;
  const FieldOfView& fov = *config_.facts.fov;
  double low = 90.0, high = -90.0, widest = 0.0;
  std::vector<Beam> beams;
  for (std::uint64_t index = 0; index < 10; ++index) {
    pattern_->beams(index, beams);
    for (const Beam& beam : beams) {
      low = std::min(low, elevation_deg(beam.direction));
      high = std::max(high, elevation_deg(beam.direction));
      widest = std::max(widest, degrees(std::atan2(std::abs(beam.direction.y()),
                                                   static_cast<double>(beam.direction.x()))));
    }
  }
  const double half = fov.half_angle_deg;
  EXPECT_NEAR(low, std::max(fov.elevation_min_deg, -half), kMargin);
  EXPECT_NEAR(high, std::min(fov.elevation_max_deg, half), kMargin);
  EXPECT_NEAR(widest, std::min(fov.azimuth_max_deg, half), kMargin);
}

/// A scan from within the box [-6, 6] x [-5, 5] x [-3, 3] m, at rest.
Scan scan_of_box(const SensorConfig& config, bool noise) {
  world::TriangleMesh box;
  for (const double z : {-3.0, 3.0}) {
    for (const auto& [x, y] : {std::pair{-6.0, -5.0}, {6.0, -5.0}, {6.0, 5.0}, {-6.0, 5.0}})
      box.vertices.emplace_back(x, y, z);
  }
  box.triangles = {{0, 2, 1}, {0, 3, 2}, {4, 5, 6}, {4, 6, 7}, {0, 1, 5}, {0, 5, 4},
                   {1, 2, 6}, {1, 6, 5}, {2, 3, 7}, {2, 7, 6}, {3, 0, 4}, {3, 4, 7}};
  const Lidar lidar(config, make_pattern(config), config.name, 1, noise);
  return lidar.measure(world::World(box), rest(Pose::Identity()), 0, kOneThread);
}

double distance_to_wall(const SensorConfig& config, const Point& point) {
  return distance_to_box({-6, -5, -3}, {6, 5, 3},
                         config.body_from_lidar * point.position.cast<double>());
}

TEST_P(ShippedSensor, SeesAllOfARoomExactlyWithoutNoise) {
  SensorConfig config = config_;
  config.noise.beam = {};  // a beam with a width mixes what it hits in the corners
  config.returns = {};
  const Scan scan = scan_of_box(config, false);
  EXPECT_EQ(scan.points.size(), pattern_->beams_per_scan()) << "all walls are within its range";
  double worst = 0.0;
  for (const Point& point : scan.points) worst = std::max(worst, distance_to_wall(config, point));
  EXPECT_LT(worst, 1e-5);
}

TEST_P(ShippedSensor, HasTheRangeNoiseOfItsFileInARoom) {
  SensorConfig config = config_;
  config.noise.beam = {};
  config.noise.bias = {};  // see lidar_errors_test.cpp
  config.returns = {};
  if (config.imu) config.imu->vibration_moves_lidar = false;
  const Scan exact = scan_of_box(config, false), noisy = scan_of_box(config, true);
  // The walls are nearer than the rated range of dark surfaces: no echo is missed.
  ASSERT_EQ(noisy.points.size(), exact.points.size());
  double sum = 0.0;
  std::size_t count = 0;
  for (std::size_t i = 0; i < exact.points.size(); ++i) {
    const double range = exact.points[i].position.norm();
    if (range < config.noise.near_until_m) continue;
    const double error = noisy.points[i].position.norm() - range;
    sum += error * error;
    ++count;
  }
  const double step = config.noise.range_step_m;
  const double expected = std::hypot(config.range_noise_m, step / std::sqrt(12.0));
  // A sample's standard deviation deviates by 1 / sqrt(2 n): 0.75 % for 9,000 points.
  ASSERT_GT(count, 9'000U);
  EXPECT_NEAR(std::sqrt(sum / static_cast<double>(count)), expected, 0.04 * expected + 1e-6);
}

INSTANTIATE_TEST_SUITE_P(All, ShippedSensor, ::testing::ValuesIn(shipped()),
                         [](const auto& test) { return test.param; });

std::vector<HeadBeam> rows_of(const std::string& name) {
  return shipped_sensor(name).beam_table->beams;
}

TEST(SpinningRows, ThirtyTwoRowsOfAnOusterOs1AreEveryFourthOfItsHundredAndTwentyEight) {
  const auto few = rows_of("ouster_os1_32");
  const auto many = rows_of("ouster_os1_128");
  ASSERT_EQ(few.size(), 32U);
  ASSERT_EQ(many.size(), 128U);
  for (std::size_t i = 0; i < few.size(); ++i) {
    EXPECT_EQ(few[i].elevation_deg, many[4 * i + 3].elevation_deg);
    EXPECT_EQ(few[i].azimuth_offset_deg, many[4 * i + 3].azimuth_offset_deg);
  }
}

TEST(SpinningRows, SixtyFourRowsOfAnOusterOs0AreEverySecondOfItsHundredAndTwentyEight) {
  const auto rows = rows_of("ouster_os0_64");
  ASSERT_EQ(rows.size(), 64U);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const OusterRow expected = os0_128_row(static_cast<int>(2 * i + 1));
    EXPECT_NEAR(rows[i].elevation_deg, degrees(expected.altitude), 5e-5);
    EXPECT_NEAR(rows[i].azimuth_offset_deg, -degrees(expected.azimuth_offset), 5e-5);
  }
}

TEST(SpinningRows, AVlp32cFiresSixteenPairs) {
  std::vector<double> times;
  for (const HeadBeam& beam : rows_of("velodyne_vlp32c")) times.push_back(beam.dt_us);
  std::ranges::sort(times);
  ASSERT_EQ(times.size(), 32U);
  for (std::size_t i = 0; i < times.size(); ++i)
    EXPECT_NEAR(times[i], 2.304 * static_cast<double>(i / 2), 1e-9);
}

TEST(SpinningRows, AscendOrDescendFromRingToRing) {
  for (const char* name : {"velodyne_vlp32c", "velodyne_hdl64e", "hesai_xt32", "hesai_qt64",
                           "robosense_helios32", "robosense_airy", "ouster_os0_32", "ouster_os0_64",
                           "ouster_os1_32", "ouster_os1_128", "ouster_os2_128"}) {
    std::vector<double> rows;
    for (const HeadBeam& beam : rows_of(name)) rows.push_back(beam.elevation_deg);
    if (rows.front() > rows.back()) std::ranges::reverse(rows);
    EXPECT_TRUE(std::ranges::is_sorted(rows, std::ranges::less_equal{})) << name;
  }
}

}  // namespace
}  // namespace lidarena::sensor
