// SPDX-License-Identifier: BSD-3-Clause
// Bias, directions, clock and vibration of a LiDAR, compared with closed forms and statistics.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <map>
#include <numbers>

#include "lidarena/sensor/lidar_shake.hpp"
#include "lidarena/sensor/simulate.hpp"
#include "tests/sensor/flights.hpp"
#include "tests/sensor/shipped.hpp"
#include "tests/sensor/worlds.hpp"

namespace lidarena::sensor {
namespace {

using Eigen::Vector3d;
using namespace testing;
using namespace world::testing;

SensorConfig level_ouster() {
  SensorConfig config = ouster();
  config.body_from_lidar.setIdentity();
  config.max_range_m = 200.0;
  config.range_noise_m = 0.0;
  return config;
}

struct Sighting {
  Scan scan;
  std::vector<PointTruth> truth;
  /// Sighting minus true range, from the axis.
  double error(std::size_t i, double beam_origin) const {
    const Vector3d point = scan.points[i].position.cast<double>();
    const Vector3d foot = beam_origin * Vector3d(point.x(), point.y(), 0.0).normalized();
    return (point - foot).norm() + beam_origin - static_cast<double>(truth[i].range);
  }
};

Sighting look(const SensorConfig& config, const world::World& world, std::uint64_t seed = 1) {
  Sighting measured;
  measured.scan = make_lidar(config, seed)
                      .measure(world, rest(Pose::Identity()), 0, kOneThread, &measured.truth);
  return measured;
}

/// A sphere around the sensor: every ray of a Mid-360 (whose beams begin in one point) meets it at
/// nearly normal incidence.
const world::World& sphere() {
  static const world::World world(sphere_mesh(10.0, 6), "sphere", world::RayCaster::kBvh);
  return world;
}

SensorConfig level_livox() {
  SensorConfig config = mid360();
  config.body_from_lidar.setIdentity();
  config.max_range_m = 200.0;
  return config;
}

TEST(LidarBias, OfAUnitIsOneNumberForAllRangesWithTheGivenSigmaOverUnits) {
  SensorConfig config = level_livox();
  config.noise.bias.unit_m = 0.02;
  const Sighting one = look(config, sphere());
  for (std::size_t i = 0; i < one.scan.points.size(); ++i)
    ASSERT_NEAR(one.error(i, 0.0), one.error(0, 0.0), 5e-6);

  const int units = 2000;
  double sum = 0.0, squares = 0.0;
  for (int seed = 0; seed < units; ++seed) {
    const double bias =
        LidarBias(config.noise.bias, "a", static_cast<std::uint64_t>(seed), 1).range(0, 1.0, 0.5);
    sum += bias;
    squares += bias * bias;
  }
  EXPECT_NEAR(sum / units / 0.02, 0.0, 4.0 / std::sqrt(units));
  EXPECT_NEAR(std::sqrt(squares / units) / 0.02, 1.0, 4.0 / std::sqrt(2.0 * units));
}

TEST(LidarBias, OfAChannelIsTheSameInEveryScanAndUncorrelatedBetweenChannels) {
  SensorConfig config = level_ouster();
  config.noise.bias.channel_m = 0.01;
  const world::World room(box_mesh({-9, -7, -4}, {8, 6, 3}), "room", world::RayCaster::kBvh);
  SensorConfig exact = config;
  exact.noise.bias = {};
  const Sighting biased = look(config, room), unbiased = look(exact, room);
  std::map<int, double> bias;
  for (std::size_t i = 0; i < biased.scan.points.size(); ++i) {
    const Point& p = biased.scan.points[i];
    const double off = (p.position - unbiased.scan.points[i].position).norm();
    const auto [place, is_new] = bias.try_emplace(p.ring, off);
    ASSERT_NEAR(place->second, off, 5e-6);
  }
  ASSERT_EQ(bias.size(), 128U);

  const std::size_t channels = 4000;
  const LidarBias drawn(config.noise.bias, "a", 3, channels);
  double squares = 0.0, products = 0.0;
  for (std::size_t i = 0; i < channels; ++i) {
    const double here = drawn.range(static_cast<std::uint16_t>(i), 1.0, 0.5);
    const double next = drawn.range(static_cast<std::uint16_t>((i + 1) % channels), 1.0, 0.5);
    squares += here * here;
    products += here * next;
  }
  const double count = channels;
  EXPECT_NEAR(std::sqrt(squares / count) / 0.01, 1.0, 4.0 / std::sqrt(2.0 * count));
  EXPECT_NEAR(products / squares, 0.0, 4.0 / std::sqrt(count));
}

TEST(LidarBias, ByIncidenceIsZeroAtNormalIncidenceAndTheGivenValueAtSixtyDegrees) {
  BiasConfig config;
  config.incidence_m = 0.01;
  const LidarBias bias(config, "a", 1, 1);
  EXPECT_NEAR(bias.range(0, 1.0, 0.5), 0.0, 1e-15);
  EXPECT_NEAR(bias.range(0, 0.5, 0.5), 0.01, 1e-15);
  EXPECT_EQ(bias.range(0, 0.0, 0.5), bias.range(0, std::cos(radians(86)), 0.5));

  SensorConfig sensor = level_livox();
  sensor.noise.bias = config;
  const world::World wall(wall_mesh(5.0), "wall", world::RayCaster::kBvh);
  const Sighting measured = look(sensor, wall);
  for (std::size_t i = 0; i < measured.scan.points.size(); ++i) {
    const double cosine =
        std::abs(measured.scan.points[i].position.normalized().dot(Eigen::Vector3f::UnitX()));
    if (cosine < 0.1) continue;
    ASSERT_NEAR(measured.error(i, 0.0), 0.01 * (1.0 / cosine - 1.0), 2e-5);
  }
}

TEST(LidarBias, ByReflectivityGrowsWithEachTenthOfTheLight) {
  SensorConfig sensor = level_livox();
  sensor.noise.bias.reflectivity_m = 0.03;
  for (const auto& [reflectivity, expected] :
       std::map<double, double>{{0.05, 0.03}, {0.5, 0.0}, {1.0, -0.03 * std::log10(2.0)}}) {
    world::TriangleMesh mesh = sphere_mesh(10.0, 5);
    mesh.paint({"paint", reflectivity, 0.0});
    const world::World painted(std::move(mesh), "painted", world::RayCaster::kBvh);
    const Sighting measured = look(sensor, painted);
    for (std::size_t i = 0; i < measured.scan.points.size(); i += 97)
      ASSERT_NEAR(measured.error(i, 0.0), expected, 5e-6);
  }
}

TEST(LidarBias, OfDirectionsTurnsEachChannelByAFixedAngleOfTheGivenSigma) {
  SensorConfig config = level_ouster();
  config.noise.bias.direction_deg = 0.1;
  SensorConfig exact = config;
  exact.noise.bias = {};
  const world::World room(box_mesh({-9, -7, -4}, {8, 6, 3}), "room", world::RayCaster::kBvh);
  const Sighting off = look(config, room), on = look(exact, room);
  std::map<int, double> angles;
  for (std::size_t i = 0; i < on.scan.points.size(); ++i) {
    const Vector3d a = off.scan.points[i].position.cast<double>();
    const Vector3d b = on.scan.points[i].position.cast<double>();
    const double angle = (a - b).norm() / static_cast<double>(on.truth[i].range);
    const auto [place, is_new] = angles.try_emplace(on.scan.points[i].ring, angle);
    ASSERT_NEAR(place->second, angle, 0.02 * place->second + 1e-5);  // the axis is not the origin
  }
  const std::size_t channels = 4000;
  const LidarBias drawn(config.noise.bias, "a", 3, channels);
  Eigen::Vector2d squares = Eigen::Vector2d::Zero();
  for (std::size_t i = 0; i < channels; ++i)
    squares += drawn.direction(static_cast<std::uint16_t>(i)).cast<double>().cwiseAbs2();
  for (int axis = 0; axis < 2; ++axis) {
    EXPECT_NEAR(degrees(std::sqrt(squares[axis] / static_cast<double>(channels))) / 0.1, 1.0,
                4.0 / std::sqrt(2.0 * channels));
  }
}

TEST(LidarClock, WithOffsetAndDriftShowsALinearFunctionOfTrueTime) {
  SensorConfig config = level_livox();
  config.noise.clock.offset_s = 0.003;
  config.noise.clock.drift = 1e-4;
  const Lidar lidar = make_lidar(config);
  SensorConfig exact = config;
  exact.noise.clock = {};
  for (const std::uint64_t index : {0U, 7U, 400U}) {
    const Time begin = lidar.begin(index);
    EXPECT_EQ(begin, std::chrono::milliseconds(100 * index));
    EXPECT_NEAR(to_seconds(lidar.stamp(index)), 0.003 + (1.0 + 1e-4) * to_seconds(begin), 1e-9);
    const Scan scan = lidar.measure(sphere(), rest(Pose::Identity(), 60), index, kOneThread);
    const Scan same =
        make_lidar(exact).measure(sphere(), rest(Pose::Identity(), 60), index, kOneThread);
    ASSERT_EQ(scan.points.size(), same.points.size());
    EXPECT_EQ(scan.stamp, lidar.stamp(index));
    for (std::size_t i = 0; i < scan.points.size(); i += 11) {
      EXPECT_EQ(scan.points[i].position, same.points[i].position);
      ASSERT_NEAR(scan.points[i].dt_ns, (1.0 + 1e-4) * same.points[i].dt_ns, 1.0);
    }
  }
}

TEST(LidarClock, JitterOfStampsHasTheGivenSigmaAndKeepsTheOrder) {
  const double sigma = 0.002;
  const SensorClock clock(0.1, 0.0, sigma, std::chrono::milliseconds(100), "a", 4);
  const int count = 4000;
  double squares = 0.0, products = 0.0, last = 0.0;
  for (int i = 0; i < count; ++i) {
    const Time t = std::chrono::milliseconds(100 * i);
    const double error = to_seconds(clock.stamp(static_cast<std::uint64_t>(i), t) - t) - 0.1;
    squares += error * error;
    products += error * last;
    last = error;
  }
  EXPECT_NEAR(std::sqrt(squares / count) / sigma, 1.0, 4.0 / std::sqrt(2.0 * count));
  EXPECT_NEAR(products / squares, 0.0, 4.0 / std::sqrt(count));
  const SensorClock wild(0.0, 0.0, 1.0, std::chrono::milliseconds(100), "a", 4);
  for (std::uint64_t i = 0; i < 1000; ++i) {
    const Time t = std::chrono::milliseconds(100 * i);
    EXPECT_GE(wild.stamp(i, t), Time{0});
    EXPECT_LT(wild.stamp(i, t), wild.stamp(i + 1, t + std::chrono::milliseconds(100)));
  }
}

TEST(LidarClock, ReadsTheTrueTimeBack) {
  const SensorClock clock(0.2, -3e-5, 0.0, std::chrono::milliseconds(100), "a", 4);
  for (const double s : {0.0, 0.5, 3.21, 1800.0})
    EXPECT_LE(std::abs((clock.true_time(clock.reading(from_seconds(s))) - from_seconds(s)).count()),
              1);
}

TEST(LidarClock, ScansAreDeliveredAfterTheSamplesThatCoverThemByTheStampsOfBoth) {
  SensorConfig config = level_livox();
  config.imu.emplace();
  config.noise.clock = {0.004, 1e-4, 0.003, false};
  config.imu->stamp_jitter_s = 0.001;
  config.imu->lost_share = 0.2;
  const auto flight = rest(Pose::Identity(), 2.0);
  const auto source = simulate(sphere(), flight, {config}, {}, kOneThread);
  Time imu{-1}, scan_stamp{-1};
  std::size_t scans = 0;
  while (const auto event = source->next()) {
    if (const auto* sample = std::get_if<ImuSample>(&event->data)) {
      EXPECT_GT(sample->stamp, imu);
      imu = sample->stamp;
      continue;
    }
    const Scan& scan = std::get<Scan>(event->data);
    EXPECT_GT(scan.stamp, scan_stamp);
    scan_stamp = scan.stamp;
    const bool is_last = end_of(scan) >= from_seconds(1.99);
    EXPECT_TRUE(is_last || imu >= end_of(scan));
    ++scans;
  }
  EXPECT_EQ(scans, 20U);
}

/// A tone of the given acceleration along x moves the LiDAR by a / w^2.
TEST(LidarVibration, MovesTheLidarByTheSecondIntegralOfTheImusTone) {
  SensorConfig config = level_livox();
  ImuConfig& imu = config.imu.emplace();
  const double hz = 40.0, amplitude = 60.0, w = 2.0 * std::numbers::pi * hz;
  imu.vibration.push_back({hz, {amplitude, 0, 0}, Vector3d::Zero(), true});
  imu.vibration_moves_lidar = true;
  const Vibration vibration(imu, "mid360/imu", 1);
  const world::World wall(wall_mesh(5.0), "wall", world::RayCaster::kBvh);
  const Sighting measured = look(config, wall);
  double largest = 0.0;
  for (std::size_t i = 0; i < measured.scan.points.size(); ++i) {
    const Point& p = measured.scan.points[i];
    const double shift = vibration.shift(Time{p.dt_ns}, vibration.gains(1.0)).value[0];
    ASSERT_NEAR(static_cast<double>(p.position.x()), 5.0 - shift, 1e-5);
    largest = std::max(largest, std::abs(shift));
  }
  EXPECT_NEAR(largest, amplitude / (w * w), 0.01 * amplitude / (w * w));
}

/// What the IMU feels is the second derivative of the LiDAR's shift and the rate of its rotation.
TEST(LidarVibration, AgreesWithWhatTheImuFeels) {
  ImuConfig imu;
  imu.vibration.push_back({55.0, {3, 2, 1}, {0.02, 0.03, 0.01}, true});
  imu.broadband.accel_rms = {2, 3, 4};
  imu.broadband.gyro_rms = {0.1, 0.2, 0.05};
  const Vibration vibration(imu, "a/imu", 9);
  const auto gains = vibration.gains(1.2);
  const double h = 1e-5;
  for (const double t : {0.01, 0.5, 7.3}) {
    const auto at = [&](double s) { return vibration.shift(from_seconds(s), gains); };
    const Vibration::Vector6 slope = (at(t + h).value - at(t - h).value) / (2 * h);
    EXPECT_LT((slope - at(t).rate).cwiseAbs().maxCoeff(), 1e-4);  // h^2 / 6 of the third one
    Vector3d accel = Vector3d::Zero(), gyro = Vector3d::Zero();
    vibration.add(from_seconds(t), gains, accel, gyro);
    const Vibration::Vector6 second = (at(t + h).rate - at(t - h).rate) / (2 * h);
    EXPECT_LT((second.head<3>() - accel).cwiseAbs().maxCoeff(), 1e-3);
    EXPECT_LT((at(t).rate.tail<3>() - gyro).cwiseAbs().maxCoeff(), 1e-12);
  }
}

TEST(LidarVibration, IsInterpolatedWithinAThousandthOfItsAmplitude) {
  ImuConfig imu;
  imu.broadband.accel_rms = {2, 3, 4};
  imu.broadband.gyro_rms = {0.1, 0.2, 0.05};
  const Vibration vibration(imu, "a/imu", 9);
  const Time stamp = std::chrono::milliseconds(300);
  const LidarShake shake(vibration, rest(Pose::Identity()), Pose::Identity(), stamp, 99'000'000);
  const auto gains = vibration.gains(1.0);
  for (std::int32_t dt = 0; dt <= 99'000'000; dt += 1'234'567) {
    const auto exact = vibration.shift(stamp + Time{dt}, gains).value;
    const Pose pose = shake.at(dt);
    EXPECT_LT((pose.translation() - exact.head<3>()).norm(), 1e-6);
    EXPECT_LT((pose.linear() * Vector3d(20, 0, 0) -
               (Vector3d(20, 0, 0) + exact.tail<3>().cross(Vector3d(20, 0, 0))))
                  .norm(),
              2e-5);
  }
}

/// Switches one error on in a sensor that has all errors of its data sheet.
using Switch = std::function<void(SensorConfig&)>;

struct Recording {
  std::vector<ImuSample> samples;
  std::vector<Scan> scans;
};

Recording recorded(const SensorConfig& config) {
  static const world::World room(box_mesh({-9, -7, -4}, {8, 6, 3}), "room", world::RayCaster::kBvh);
  const SwingingFlight flight(0.25);
  const auto source = simulate(room, flight, {config}, {}, kOneThread);
  Recording recording;
  while (auto event = source->next()) {
    if (auto* sample = std::get_if<ImuSample>(&event->data)) recording.samples.push_back(*sample);
    if (auto* scan = std::get_if<Scan>(&event->data)) recording.scans.push_back(std::move(*scan));
  }
  return recording;
}

/// An error changes its own quantity only: the number of points, their noise and that of the IMU
/// stay. Compared are differences of points, which must be below what the error itself does.
TEST(ErrorsOfTheirOwn, OneThatIsSwitchedOnChangesNoOtherNoise) {
  const SensorConfig plain = load_sensor(kConfigs / "livox_mid360.yaml");
  const Recording before = recorded(plain);
  const std::vector<std::pair<double, Switch>> switches{
      {0.1, [](SensorConfig& c) { c.noise.bias.unit_m = 0.01; }},
      {0.1, [](SensorConfig& c) { c.noise.bias.channel_m = 0.01; }},
      {0.2, [](SensorConfig& c) { c.noise.bias.incidence_m = 0.01; }},
      {0.1, [](SensorConfig& c) { c.noise.bias.reflectivity_m = 0.01; }},
      {0.1, [](SensorConfig& c) { c.noise.bias.direction_deg = 0.01; }},
      {0.0,
       [](SensorConfig& c) {
         c.noise.clock = {0.002, 1e-4, 1e-3, true};
       }},
      {0.1, [](SensorConfig& c) { c.noise.drift.warm_up_m = 0.01; }},
      {0.0, [](SensorConfig& c) { c.noise.bounces = 2; }},
      {0.0, [](SensorConfig& c) { c.noise.blooming.share = 0.01; }}};
  for (const auto& [largest, change] : switches) {
    SensorConfig config = plain;
    change(config);
    const Recording after = recorded(config);
    ASSERT_EQ(after.samples.size(), before.samples.size());
    for (std::size_t i = 0; i < before.samples.size(); ++i) {
      EXPECT_EQ(before.samples[i].gyro, after.samples[i].gyro);
      EXPECT_EQ(before.samples[i].accel, after.samples[i].accel);
    }
    ASSERT_EQ(after.scans.size(), before.scans.size());
    for (std::size_t i = 0; i < before.scans.size(); ++i) {
      const std::vector<Point>&a = before.scans[i].points, &b = after.scans[i].points;
      ASSERT_EQ(a.size(), b.size());
      for (std::size_t p = 0; p < a.size(); ++p)
        ASSERT_LE((a[p].position - b[p].position).norm(), largest);
    }
  }
}

TEST(ErrorsOfTheirOwn, AreOffWithoutNoise) {
  SensorConfig plain = load_sensor(kConfigs / "livox_mid360.yaml");
  SensorConfig harsh = plain;
  harsh.noise.bias = {0.1, 0.1, 0.1, 0.1, 0.5};
  harsh.noise.clock = {0.1, 1e-3, 0.01, true};
  harsh.noise.drift.warm_up_m = 0.1;
  harsh.noise.bounces = 2;
  harsh.noise.air.visibility_m = 20;
  harsh.noise.blooming.share = 0.1;
  harsh.imu->broadband.accel_rms = {9, 9, 9};
  harsh.imu->vibration_moves_lidar = true;
  harsh.imu->bandwidth_hz = 20;
  harsh.imu->delay_s = 0.01;
  harsh.imu->lost_share = 0.5;
  harsh.imu->stamp_jitter_s = 0.001;
  SimulationOptions options;
  options.noise = false;
  const SwingingFlight flight(0.25);
  const auto a = simulate(sphere(), flight, {plain}, options, kOneThread);
  const auto b = simulate(sphere(), flight, {harsh}, options, kOneThread);
  while (const auto event = a->next()) {
    const auto other = b->next();
    ASSERT_TRUE(other);
    if (const auto* sample = std::get_if<ImuSample>(&event->data)) {
      EXPECT_EQ(sample->stamp, std::get<ImuSample>(other->data).stamp);
      EXPECT_EQ(sample->accel, std::get<ImuSample>(other->data).accel);
    } else {
      EXPECT_TRUE(same(std::get<Scan>(event->data), std::get<Scan>(other->data)));
    }
  }
}

}  // namespace
}  // namespace lidarena::sensor
