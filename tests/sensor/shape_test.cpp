// SPDX-License-Identifier: BSD-3-Clause
// Properties of a sensor that can be changed one at a time: shots, field of view, repetition,
// mounting, and the grade of the IMU; compared with the unchanged sensor by geometry.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "lidarena/base/angle.hpp"
#include "lidarena/base/error.hpp"
#include "lidarena/sensor/coverage.hpp"
#include "lidarena/sensor/imu.hpp"
#include "lidarena/sensor/simulate.hpp"
#include "tests/sensor/flights.hpp"
#include "tests/sensor/shipped.hpp"
#include "tests/sensor/worlds.hpp"

namespace lidarena::sensor {
namespace {

using namespace testing;
using namespace world::testing;
using Eigen::Vector3d;
using ::testing::AllOf;
using ::testing::HasSubstr;

SensorConfig shipped_with(const std::string& sensor, const std::vector<std::string>& set) {
  return load_sensor(kConfigs / (sensor + ".yaml"), {}, set);
}

std::vector<Beam> scan_of(const SensorConfig& sensor, std::uint64_t index) {
  std::vector<Beam> beams;
  make_pattern(sensor)->beams(index, beams);
  return beams;
}

double elevation_of(const Beam& beam) {
  return std::asin(static_cast<double>(beam.direction.z())) / kDegree;
}
double azimuth_of(const Beam& beam) {
  return std::atan2(beam.direction.y(), beam.direction.x()) / kDegree;
}

std::string refusal_of(const std::string& sensor, const std::vector<std::string>& set) {
  try {
    shipped_with(sensor, set);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(ShotsPerSecond, FiresAMid360TwiceAsOftenOnTheSameCurve) {
  const SensorConfig once = shipped_with("livox_mid360", {});
  const SensorConfig twice = shipped_with("livox_mid360", {"shape.shots_per_second=400000"});
  EXPECT_EQ(make_pattern(twice)->period(), make_pattern(once)->period());
  EXPECT_EQ(make_pattern(twice)->repeats_after(), make_pattern(once)->repeats_after());
  for (const std::uint64_t scan : {0U, 7U, 119U, 121U}) {
    const std::vector<Beam> coarse = scan_of(once, scan), fine = scan_of(twice, scan);
    ASSERT_EQ(fine.size(), 2 * coarse.size());
    for (std::size_t group = 0; group + 1 < coarse.size() / 4; ++group) {
      for (std::size_t laser = 0; laser < 4; ++laser) {
        const Beam& a = coarse[4 * group + laser];
        const Beam& same = fine[8 * group + laser];
        const Beam& between = fine[8 * group + 4 + laser];
        const Beam& b = coarse[4 * group + 4 + laser];
        ASSERT_LT((same.direction - a.direction).norm(), 1e-6F);
        ASSERT_EQ(same.ring, laser);
        ASSERT_EQ(between.dt_ns - same.dt_ns, 10'000);  // groups of 4 at 5 us, at half the time
        // On a smooth curve the shot between two others is nearly their mean.
        ASSERT_LT((between.direction - 0.5F * (a.direction + b.direction)).norm(),
                  0.05F * (a.direction - b.direction).norm() + 1e-4F);
      }
    }
  }
}

TEST(ShotsPerSecond, GivesASpinningHeadOtherColumnsAtTheSameElevations) {
  const std::map<std::string, std::string> halves{
      {"ouster_os0_128", "655360"}, {"velodyne_vlp16", "144640"}, {"hesai_xt32", "320000"}};
  for (const auto& [name, shots] : halves) {
    SCOPED_TRACE(name);
    const SensorConfig whole = shipped_with(name, {});
    const SensorConfig half = shipped_with(name, {"shape.shots_per_second=" + shots});
    const std::vector<Beam> all = scan_of(whole, 0), some = scan_of(half, 0);
    ASSERT_EQ(2 * some.size(), all.size());
    const std::size_t rows = some.size() / (all.size() / 2 / (all.size() / whole.columns));
    EXPECT_EQ(rows, all.size() / static_cast<std::size_t>(whole.columns));
    double lowest[2] = {90, 90}, highest[2] = {-90, -90};
    for (const Beam& beam : all) {
      lowest[0] = std::min(lowest[0], elevation_of(beam));
      highest[0] = std::max(highest[0], elevation_of(beam));
    }
    for (const Beam& beam : some) {
      lowest[1] = std::min(lowest[1], elevation_of(beam));
      highest[1] = std::max(highest[1], elevation_of(beam));
    }
    EXPECT_NEAR(lowest[0], lowest[1], 1e-5);
    EXPECT_NEAR(highest[0], highest[1], 1e-5);
    // The first laser of a column fires where that of every second column of the whole head does.
    for (std::size_t column = 0; column < some.size() / rows; ++column) {
      const Beam& beam = some[column * rows];
      ASSERT_LT((beam.direction - all[2 * column * rows].direction).norm(), 1e-5F) << column;
      ASSERT_NEAR(beam.dt_ns, all[2 * column * rows].dt_ns, 1);
    }
  }
}

TEST(FieldOfViewShape, ScalesElevationsAboutTheMiddleAndThenShiftsThem) {
  const SensorConfig plain = shipped_with("livox_mid360", {});
  const SensorConfig shaped =
      shipped_with("livox_mid360", {"shape.fov_height_deg=29.5", "shape.fov_shift_deg=-10"});
  const std::vector<Beam> before = scan_of(plain, 3), after = scan_of(shaped, 3);
  ASSERT_EQ(before.size(), after.size());
  for (std::size_t i = 0; i < before.size(); ++i) {
    // Data sheet: -7 to 52 deg, so the middle is 22.5 deg, and 59 deg become 29.5 deg.
    ASSERT_NEAR(elevation_of(after[i]), 22.5 + 0.5 * (elevation_of(before[i]) - 22.5) - 10, 2e-5);
    ASSERT_NEAR(azimuth_of(after[i]), azimuth_of(before[i]), 2e-5);
    ASSERT_EQ(after[i].dt_ns, before[i].dt_ns);
    ASSERT_EQ(after[i].ring, before[i].ring);
  }
  const auto fov = field_of_view(shaped);
  ASSERT_TRUE(fov);
  EXPECT_NEAR(fov->elevation_min_deg, -2.25, 1e-9);
  EXPECT_NEAR(fov->elevation_max_deg, 27.25, 1e-9);
}

TEST(Repetitive, GivesEveryScanTheShotsOfTheFirst) {
  const SensorConfig plain = shipped_with("livox_mid360", {});
  const SensorConfig same = shipped_with("livox_mid360", {"shape.repetitive=true"});
  const std::vector<Beam> first = scan_of(plain, 0), other = scan_of(plain, 5);
  ASSERT_NE(first[100].direction, other[100].direction) << "a pattern that does not repeat";
  for (const std::uint64_t scan : {0U, 5U, 1000U}) {
    const std::vector<Beam> beams = scan_of(same, scan);
    ASSERT_EQ(beams.size(), first.size());
    for (std::size_t i = 0; i < beams.size(); ++i)
      ASSERT_EQ(beams[i].direction, first[i].direction);
  }
  EXPECT_EQ(make_pattern(same)->repeats_after(), 1U);
}

TEST(Clip, ReportsTheReturnsWithinAndChangesNoneOfThem) {
  const world::World room(box_mesh({-9, -7, -4}, {8, 6, 3}), "room", world::RayCaster::kBvh);
  SensorConfig plain = shipped_with("livox_mid360", {"noise.angle_noise_deg=0"});
  SensorConfig clipped = plain;
  clipped.shape.clip = FieldOfView{-60, 90, 0, 30, 180};
  clipped.name = plain.name;
  const auto scan = [&](const SensorConfig& sensor) {
    return make_lidar(sensor).measure(room, rest(Pose::Identity()), 0, kOneThread).points;
  };
  std::vector<Point> expected;
  for (const Point& point : scan(plain)) {
    const double azimuth = std::atan2(point.position.y(), point.position.x()) / kDegree;
    const double elevation = std::asin(point.position.z() / point.position.norm()) / kDegree;
    if (azimuth >= -60 && azimuth <= 90 && elevation >= 0 && elevation <= 30)
      expected.push_back(point);
  }
  const std::vector<Point> points = scan(clipped);
  ASSERT_GT(expected.size(), 1000U);
  ASSERT_EQ(points.size(), expected.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    ASSERT_EQ(points[i].position, expected[i].position);
    ASSERT_EQ(points[i].dt_ns, expected[i].dt_ns);
  }
}

TEST(Mount, TurnsAndRaisesTheLidarAndItsImu) {
  SensorConfig sensor =
      shipped_with("livox_mid360", {"mount.pitch_deg=90", "mount.yaw_deg=90", "mount.up_m=0.4"});
  const Pose pose = make_rig({sensor}).lidars.front().body_from_lidar;
  EXPECT_LT((pose.translation() - Vector3d(0, 0, 0.5)).norm(), 1e-12);
  EXPECT_LT((pose.linear() * Vector3d::UnitX() - Vector3d(0, 0, -1)).norm(), 1e-12) << "down";
  EXPECT_LT((pose.linear() * Vector3d::UnitZ() - Vector3d(0, 1, 0)).norm(), 1e-12)
      << "pitch turns it forward, then yaw to the left";

  const world::World room(box_mesh({-9, -7, -4}, {8, 6, 3}), "room", world::RayCaster::kBvh);
  SimulationOptions options;
  options.noise = false;
  options.duration = from_seconds(0.2);
  const UniformFlight flight = rest(Pose::Identity());
  const auto events = simulate(room, flight, {sensor}, options, kOneThread);
  std::size_t points = 0, samples = 0;
  while (const auto event = events->next()) {
    if (const auto* imu = std::get_if<ImuSample>(&event->data)) {
      EXPECT_LT((imu->accel - Vector3d(-sensor.imu->gravity, 0, 0)).norm(), 1e-9) << "x looks down";
      ++samples;
      continue;
    }
    for (const Point& point : std::get<Scan>(event->data).points) {
      const Vector3d p = pose * point.position.cast<double>();
      const double gap = std::min({std::abs(p.x() + 9), std::abs(p.x() - 8), std::abs(p.y() + 7),
                                   std::abs(p.y() - 6), std::abs(p.z() + 4), std::abs(p.z() - 3)});
      ASSERT_LT(gap, 1e-4);
      ++points;
    }
  }
  EXPECT_GT(points, 10'000U);
  EXPECT_GT(samples, 30U);
}

TEST(ImuErrorFactor, MultipliesAllErrorsAndWhatTheRigStates) {
  const auto error_of = [](double factor) {
    ImuConfig config = *shipped_with("livox_mid360", {}).imu;
    config.gyro_range = config.accel_range = 0.0;
    config.error_factor = factor;
    Imu imu(config, Pose::Identity(), "test", 1, true),
        ideal(ImuConfig{}, Pose::Identity(), "test", 1, false);
    Eigen::Matrix<double, 6, 1> sum = Eigen::Matrix<double, 6, 1>::Zero();
    const SwingingFlight flight(2.0);
    for (int k = 0; k < 100; ++k) {
      const ImuSample a = imu.measure(flight), b = ideal.measure(flight);
      sum += (Eigen::Matrix<double, 6, 1>() << a.gyro - b.gyro, a.accel - b.accel).finished();
    }
    return sum;
  };
  EXPECT_LT(error_of(0.0).norm(), 1e-9);
  EXPECT_GT(error_of(1.0).norm(), 0.1);
  EXPECT_LT((error_of(3.0) - 3.0 * error_of(1.0)).norm(), 1e-6 * error_of(3.0).norm());
  const SensorConfig better = shipped_with("livox_mid360", {"imu.error_factor=0.5"});
  const ImuInfo told = make_rig({better}).imus.front();
  EXPECT_DOUBLE_EQ(told.gyro_noise_density, 0.5 * better.imu->gyro_noise_density);
  EXPECT_DOUBLE_EQ(told.accel_bias_walk, 0.5 * better.imu->accel_bias_walk);
}

TEST(Shape, SaysWhatAPatternCannotBe) {
  EXPECT_THAT(
      refusal_of("ouster_os0_128", {"shape.shots_per_second=393216"}),
      AllOf(HasSubstr("ouster_os0_128.yaml"), HasSubstr("307.2"), HasSubstr("a multiple of 1280")));
  EXPECT_THAT(refusal_of("livox_mid360", {"shape.shots_per_second=66666"}),
              AllOf(HasSubstr("livox_mid360.yaml"), HasSubstr("a multiple of 40")));
  EXPECT_THAT(refusal_of("livox_mid360", {"shape.shots_per_second=-1"}),
              HasSubstr("shots_per_second"));
  EXPECT_THAT(refusal_of("livox_mid360", {"shape.fov_shift_deg=60"}),
              AllOf(HasSubstr("beyond 90 deg"), HasSubstr("fov_shift_deg")));
  EXPECT_THAT(refusal_of("livox_mid360", {"shape.fov_height_deg=200"}),
              HasSubstr("fov_height_deg"));
  EXPECT_THAT(
      refusal_of("livox_mid360", {"shape.clip={elevation_min_deg: 20, elevation_max_deg: 5}"}),
      HasSubstr("shape.clip is empty"));
  SensorConfig unknown = shipped_with("livox_mid360", {});
  unknown.facts.fov.reset();
  unknown.shape.fov_shift_deg = 5;
  EXPECT_THROW(make_pattern(unknown), InputError);
}

}  // namespace
}  // namespace lidarena::sensor
