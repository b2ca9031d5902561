// SPDX-License-Identifier: BSD-3-Clause
// Returns of shots, compared with closed forms: noise, dropouts, rounding, mixed pixels, echoes.
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <numbers>

#include "tests/sensor/flights.hpp"
#include "tests/sensor/worlds.hpp"

namespace lidarena::sensor {
namespace {

using Eigen::Vector3d;
using namespace testing;
using namespace world::testing;

const Parallel kOneThread(1);

/// Fires repeatedly in the directions of the given azimuths, horizontally.
class FixedPattern : public ScanPattern {
 public:
  FixedPattern(std::vector<double> azimuths, std::size_t times)
      : azimuths_(std::move(azimuths)), times_(times) {}
  Time period() const override { return std::chrono::milliseconds(100); }
  std::size_t beams_per_scan() const override { return azimuths_.size() * times_; }
  void beams(std::uint64_t, std::vector<Beam>& out) const override {
    out.clear();
    for (std::size_t i = 0; i < beams_per_scan(); ++i) {
      const std::size_t which = i % azimuths_.size();
      Beam beam;
      beam.direction =
          Vector3d(std::cos(azimuths_[which]), std::sin(azimuths_[which]), 0).cast<float>();
      beam.dt_ns = static_cast<std::int32_t>(i);
      beam.ring = static_cast<std::uint16_t>(which);
      out.push_back(beam);
    }
  }

 private:
  std::vector<double> azimuths_;
  std::size_t times_;
};

SensorConfig level_mid360() {
  SensorConfig config = mid360();
  config.body_from_lidar.setIdentity();
  config.max_range_m = 200.0;
  return config;
}

world::TriangleMesh painted(world::TriangleMesh mesh, double reflectivity) {
  mesh.paint({"paint", reflectivity, 0.0});
  return mesh;
}

/// Signal according to the Mid-360's data sheet: 10 % at 40 m, 80 % at 70 m. 1 for a 10 % target at
/// 40 m.
double mid360_signal(double reflectivity, double cosine, double range) {
  const double extinction = std::log(8.0 * 40.0 * 40.0 / (70.0 * 70.0)) / (2.0 * 30.0);
  return reflectivity * cosine / 0.1 * (40.0 * 40.0) / (range * range) *
         std::exp(-2.0 * extinction * (range - 40.0));
}

struct Measured {
  Scan scan;
  std::vector<PointTruth> truth;
  double error(std::size_t i) const {
    return scan.points[i].position.cast<double>().norm() - static_cast<double>(truth[i].range);
  }
  double cosine(std::size_t i) const {
    return std::abs(truth[i].normal.dot(scan.points[i].position.normalized()));
  }
};

Measured measure(const Lidar& lidar, const world::World& world, std::uint64_t index = 0) {
  Measured measured;
  measured.scan = lidar.measure(world, rest(Pose::Identity()), index, kOneThread, &measured.truth);
  return measured;
}

/// Checks that `values` have mean 0 and standard deviation 1, within four standard errors.
void expect_unit_sigma(const std::vector<double>& values, const std::string& what) {
  ASSERT_GT(values.size(), 500U) << what;
  double sum = 0.0, squares = 0.0;
  for (const double value : values) {
    sum += value;
    squares += value * value;
  }
  const auto n = static_cast<double>(values.size());
  EXPECT_NEAR(sum / n, 0.0, 4.0 / std::sqrt(n)) << what;
  EXPECT_NEAR(std::sqrt(squares / n), 1.0, 4.0 / std::sqrt(2.0 * n)) << what;
}

TEST(Returns, NearRangesAreAsNoisyAsTheSheetSays) {
  SensorConfig config = level_mid360();
  config.range_noise_m = 0.02;
  config.noise.near_range_noise_m = 0.03;
  const std::map<double, double> sigmas{{0.2, 0.03}, {0.6, 0.025}, {1.0, 0.02}, {10.0, 0.02}};
  for (const auto& [distance, sigma] : sigmas) {
    const world::World world(wall_mesh(distance));
    std::vector<double> errors;
    for (std::uint64_t index = 0; index < 4; ++index) {
      const Measured measured = measure(make_lidar(config), world, index);
      for (std::size_t i = 0; i < measured.truth.size(); ++i) {
        const double range = static_cast<double>(measured.truth[i].range);
        // Near normal incidence: within 2 % in range, so within 2 % of the change of sigma.
        if (range < 1.02 * distance) errors.push_back(measured.error(i) / sigma);
      }
    }
    expect_unit_sigma(errors, std::to_string(distance));
  }
}

TEST(Returns, WeakSignalsAreNoisierByTheRootOfTheSignalAtEveryRangeAndIncidence) {
  SensorConfig config = level_mid360();
  config.range_noise_m = 0.02;
  config.noise.weak_signal_noise = true;
  config.noise.signal = {.range_at_10_m = 40.0, .range_at_80_m = 70.0};
  // A dark wall: the signal is 1 at normal incidence at 24 m, and falls off in all directions.
  const double reflectivity = 1.0 / mid360_signal(1.0, 1.0, 24.0);
  const world::World world(painted(wall_mesh(24.0), reflectivity));
  std::map<int, std::vector<double>> by_incidence;  // in steps of 15 deg
  for (std::uint64_t index = 0; index < 3; ++index) {
    const Measured measured = measure(make_lidar(config), world, index);
    for (std::size_t i = 0; i < measured.truth.size(); ++i) {
      const double range = static_cast<double>(measured.truth[i].range);
      const double cosine = measured.cosine(i);
      const double signal = mid360_signal(reflectivity, cosine, range);
      by_incidence[static_cast<int>(degrees(std::acos(cosine)) / 15.0)].push_back(
          measured.error(i) / (0.02 / std::sqrt(signal)));
    }
  }
  ASSERT_GE(by_incidence.size(), 4U);
  for (int step = 0; step < 4; ++step) {
    expect_unit_sigma(by_incidence[step], std::to_string(15 * step) + " deg");
  }
}

TEST(Returns, EchoesDropOutAsOftenAsTheReceiverMissesThem) {
  SensorConfig config = level_mid360();
  config.noise.dropouts = true;
  config.noise.signal = {.range_at_10_m = 40.0, .range_at_80_m = 70.0};
  const double threshold = 3.719016485455709;  // a Gaussian exceeds it with probability 1e-4
  const double rated = threshold + 1.2815515655446004;  // and with this offset in nine of ten cases
  for (const auto& [distance, reflectivity] :
       {std::pair{40.0, 0.1}, {60.0, 0.8}, {30.0, 0.04}, {10.0, 0.5}}) {
    const world::World world(painted(wall_mesh(distance), reflectivity));
    SensorConfig without_dropouts = config;
    without_dropouts.noise.dropouts = false;
    const Measured all = measure(make_lidar(without_dropouts), world);
    double expected = 0.0, variance = 0.0;
    for (std::size_t i = 0; i < all.truth.size(); ++i) {
      const double signal =
          mid360_signal(reflectivity, all.cosine(i), static_cast<double>(all.truth[i].range));
      const double p = 0.5 * std::erfc((threshold - rated * signal) / std::numbers::sqrt2);
      expected += p;
      variance += p * (1.0 - p);
    }
    const Measured seen = measure(make_lidar(config), world);
    EXPECT_NEAR(static_cast<double>(seen.scan.points.size()), expected,
                4.0 * std::sqrt(variance) + 0.5)
        << distance << " m, " << reflectivity;
    EXPECT_LT(seen.scan.points.size(), all.scan.points.size());
  }
}

TEST(Returns, HeadOnAtTheRatedRangeNineOfTenComeBack) {
  SensorConfig config = level_mid360();
  config.noise.dropouts = true;
  config.noise.signal = {.range_at_10_m = 40.0, .range_at_80_m = 70.0};
  for (const auto& [distance, reflectivity] : {std::pair{40.0, 0.1}, {70.0, 0.8}}) {
    const world::World world(painted(wall_mesh(distance), reflectivity));
    const Lidar lidar(config, std::make_unique<FixedPattern>(std::vector{0.0}, 20'000), "x", 1,
                      true);
    const auto seen = static_cast<double>(measure(lidar, world).scan.points.size());
    EXPECT_NEAR(seen / 20'000, 0.9, 4.0 * std::sqrt(0.9 * 0.1 / 20'000));
  }
}

TEST(Returns, AMirrorIsSeenHeadOnAlone) {
  world::TriangleMesh mesh = wall_mesh(20.0);
  mesh.paint(world::materials::kMirror);
  const world::World world(std::move(mesh));
  SensorConfig config = level_mid360();
  config.noise.dropouts = true;
  config.noise.signal = {.range_at_10_m = 40.0, .range_at_80_m = 70.0};
  const Measured seen = measure(make_lidar(config), world);
  const Measured all = measure(make_lidar(level_mid360()), world);
  EXPECT_GT(seen.scan.points.size(), 100U);
  EXPECT_LT(seen.scan.points.size(), all.scan.points.size() / 4);
  std::size_t oblique = 0;
  for (std::size_t i = 0; i < seen.truth.size(); ++i) oblique += seen.cosine(i) < std::cos(0.7);
  EXPECT_LT(oblique, all.truth.size() / 1000);
}

TEST(Returns, RangesAreRoundedToTheStepAndNotMoved) {
  SensorConfig config = level_mid360();
  config.noise.range_step_m = 0.05;
  const world::World world(box_mesh({-9, -8, -3}, {7, 6, 5}));
  for (SensorConfig sensor : {config, ouster()}) {
    sensor.noise.range_step_m = 0.05;
    std::vector<PointTruth> truth;
    const Lidar lidar = make_lidar(sensor);
    const Scan scan = lidar.measure(world, rest(Pose::Identity()), 0, kOneThread, &truth);
    std::vector<Beam> beams;
    lidar.pattern().beams(0, beams);
    ASSERT_EQ(scan.points.size(), beams.size());
    double squares = 0.0;
    for (std::size_t i = 0; i < beams.size(); ++i) {
      const double range = static_cast<double>(beams[i].origin.norm() +
                                               (scan.points[i].position - beams[i].origin).norm());
      EXPECT_NEAR(range / 0.05, std::round(range / 0.05), 1e-4);
      const double error = range - static_cast<double>(truth[i].range);
      EXPECT_LT(std::abs(error), 0.025 + 1e-5);
      squares += error * error;
    }
    // Uniform distribution over a step: variance step^2 / 12, to 5 % over the many ranges in a box.
    EXPECT_NEAR(std::sqrt(squares / static_cast<double>(beams.size())), 0.05 / std::sqrt(12.0),
                0.05 * 0.05 / std::sqrt(12.0));
  }
}

TEST(Returns, DirectionsAreReportedWithTheAngularNoiseOfTheSheet) {
  SensorConfig config = level_mid360();
  config.noise.angle_noise_deg = 0.15;
  const world::World world(box_mesh({-9, -8, -3}, {7, 6, 5}));
  const Lidar lidar = make_lidar(config);
  const Measured noisy = measure(lidar, world);
  std::vector<Beam> beams;
  lidar.pattern().beams(0, beams);
  ASSERT_EQ(noisy.scan.points.size(), beams.size());
  std::vector<double> left, up;
  for (std::size_t i = 0; i < beams.size(); ++i) {
    const Vector3d axis = beams[i].direction.cast<double>();
    const Vector3d reported = noisy.scan.points[i].position.cast<double>().normalized();
    const Vector3d leftwards = Vector3d::UnitZ().cross(axis).normalized();
    left.push_back(reported.dot(leftwards) / radians(0.15));
    up.push_back(reported.dot(axis.cross(leftwards)) / radians(0.15));
    EXPECT_NEAR(noisy.error(i), 0.0, 1e-4);  // the range is the true one
  }
  expect_unit_sigma(left, "left");
  expect_unit_sigma(up, "up");
}

/// A plate at x = 5 m for y > 0 (to the left), behind it a wall at `far`.
world::World edge_world(double far) {
  world::TriangleMesh mesh = wall_mesh(far);
  world::TriangleMesh plate;
  plate.vertices = {{5, 0, -60}, {5, 60, -60}, {5, 60, 60}, {5, 0, 60}};
  plate.triangles = {{0, 1, 2}, {0, 2, 3}};
  mesh.append(plate);
  return world::World(std::move(mesh));
}

SensorConfig wide_beam(int sub_rays) {
  SensorConfig config = level_mid360();
  config.noise.beam = {.sub_rays = sub_rays, .width_deg = 0.3, .height_deg = 0.1};
  return config;
}

constexpr double kSigma =
    0.3 / 2.3548200450309493 * std::numbers::pi / 180.0;  // rad, from the beam width
const std::vector<double> kOffsets{-2.5 * kSigma, -kSigma, -0.3 * kSigma, 0.0,
                                   0.5 * kSigma,  kSigma,  3.0 * kSigma};

TEST(Returns, ABeamOnAnEdgeMixesTheTwoRangesByTheShareThatFallsOnEach) {
  const double far = 5.3;  // within a pulse of the plate
  const world::World world = edge_world(far);
  const Lidar lidar(wide_beam(64), std::make_unique<FixedPattern>(kOffsets, 400), "x", 1, true);
  const Measured measured = measure(lidar, world);
  ASSERT_EQ(measured.scan.points.size(), 400 * kOffsets.size());
  std::map<int, double> mean;
  for (const Point& point : measured.scan.points) {
    mean[point.ring] += point.position.cast<double>().norm() / 400.0;
  }
  for (std::size_t i = 0; i < kOffsets.size(); ++i) {
    const double on_plate = 0.5 * std::erfc(-kOffsets[i] / kSigma / std::numbers::sqrt2);
    const double near_signal = on_plate / (5.0 * 5.0);
    const double far_signal = (1.0 - on_plate) / (far * far);
    const double expected = (near_signal * 5.0 + far_signal * far) / (near_signal + far_signal);
    // The share is accurate to half a sub-ray of 64.
    EXPECT_NEAR(mean[static_cast<int>(i)], expected, 0.3 * 0.5 / 64 + 1e-4) << i;
  }
}

TEST(Returns, ABeamOnAnEdgeAPulseApartGivesTwoEchoesOfTheirShares) {
  const world::World world = edge_world(9.0);
  SensorConfig config = wide_beam(64);
  config.returns.count = 2;
  const Lidar lidar(config, std::make_unique<FixedPattern>(kOffsets, 400), "x", 1, true);
  const Measured measured = measure(lidar, world);
  std::map<int, double> near_share;
  for (std::size_t i = 0; i < measured.scan.points.size(); ++i) {
    const Point& point = measured.scan.points[i];
    const bool is_near = point.position.x() < 7.0F;
    EXPECT_NEAR(point.position.x(), is_near ? 5.0 : 9.0, 1e-3);  // nothing in between
    EXPECT_NEAR(measured.truth[i].position.x(), is_near ? 5.0 : 9.0, 1e-5);
    // Default reflectivity 50 % (Material{}); 255 is white.
    if (is_near) near_share[point.ring] += static_cast<double>(point.intensity) / 127.5 / 400.0;
  }
  for (std::size_t i = 0; i < kOffsets.size(); ++i) {
    const double expected = 0.5 * std::erfc(-kOffsets[i] / kSigma / std::numbers::sqrt2);
    EXPECT_NEAR(near_share[static_cast<int>(i)], expected, 0.5 / 64) << i;
  }
}

TEST(Returns, TheChoiceOfEchoesIsTheSensors) {
  const world::World world = edge_world(9.0);
  // Most of the beam misses the plate, but the wall is farther: with the square law the signals of
  // plate and wall are as 0.31 / 25 to 0.69 / 81, so the plate is stronger.
  const std::vector<double> offsets{-0.5 * kSigma};
  const auto xs = [&](EchoChoice choice, int count) {
    SensorConfig config = wide_beam(64);
    config.returns.choice = choice;
    config.returns.count = count;
    const Lidar lidar(config, std::make_unique<FixedPattern>(offsets, 1), "x", 1, true);
    std::vector<int> out;
    const Scan scan = measure(lidar, world).scan;
    for (std::size_t i = 0; i < scan.points.size(); ++i) {
      EXPECT_EQ(scan.points[i].echo, i);
      out.push_back(static_cast<int>(std::lround(scan.points[i].position.x())));
    }
    return out;
  };
  EXPECT_EQ(xs(EchoChoice::kStrongest, 1), (std::vector<int>{5}));
  EXPECT_EQ(xs(EchoChoice::kStrongest, 3), (std::vector<int>{5, 9}));
  EXPECT_EQ(xs(EchoChoice::kFirst, 1), (std::vector<int>{5}));
  EXPECT_EQ(xs(EchoChoice::kLast, 1), (std::vector<int>{9}));
  EXPECT_EQ(xs(EchoChoice::kLast, 2), (std::vector<int>{9, 5}));
}

TEST(Returns, ASplitBeamOnAPlainWallMeasuresTheWall) {
  const world::World world(wall_mesh(10.0));
  const Lidar lidar(wide_beam(19), std::make_unique<FixedPattern>(std::vector{0.0, 0.3}, 100), "x",
                    1, true);
  const Measured measured = measure(lidar, world);
  ASSERT_EQ(measured.scan.points.size(), 200U);
  for (const Point& point : measured.scan.points) {
    // Sub-rays deviate by a few sigma of 2.2e-3 rad. On average this is a second-order effect; at
    // 0.3 rad the mean of 19 sub-rays leaves a tenth of the first-order effect, 10 m * 2.2e-3 *
    // tan(0.3) / cos(0.3).
    EXPECT_NEAR(point.position.x(), 10.0, 1e-3);
  }
}

TEST(Returns, SignalIntensityIsTheLidarEquation) {
  SensorConfig config = level_mid360();
  config.returns.intensity = IntensityKind::kSignal;
  const world::World world(painted(wall_mesh(10.0), 0.3));
  const Measured measured = measure(make_lidar(config), world);
  ASSERT_GT(measured.scan.points.size(), 1000U);
  for (std::size_t i = 0; i < measured.scan.points.size(); ++i) {
    const double range = static_cast<double>(measured.truth[i].range);
    const double expected = 0.3 * (10.0 / range) / 0.1 / (range * range);  // cos = 10 / range
    EXPECT_NEAR(measured.scan.points[i].intensity, expected, 1e-4 * expected);
  }
}

SensorConfig with_everything(SensorConfig config) {
  config.range_noise_m = 0.02;
  config.noise = {.near_range_noise_m = 0.03,
                  .angle_noise_deg = 0.1,
                  .range_step_m = 0.001,
                  .weak_signal_noise = true,
                  .dropouts = true,
                  .signal = {.range_at_10_m = 8.0, .range_at_80_m = 12.0},
                  .beam = {.sub_rays = 5, .width_deg = 0.4, .height_deg = 0.4}};
  config.returns.count = 2;
  return config;
}

TEST(Returns, WithAllPartsOnScansAreTheSameOnAnyNumberOfThreadsAndInAnyOrder) {
  world::TriangleMesh mesh = box_mesh({-9, -8, -3}, {7, 6, 5});
  mesh.append(box_mesh({2, 1, -3}, {3, 2, 1}));
  mesh.append(box_mesh({-3, -2, -1}, {-2.5, -1, 1}));
  const world::World world(std::move(mesh));
  const SwingingFlight flight(2.0);
  for (const SensorConfig& config : {with_everything(mid360()), with_everything(ouster())}) {
    const Lidar lidar = make_lidar(config);
    std::vector<Scan> scans;
    for (std::uint64_t i = 0; i < 3; ++i) {
      scans.push_back(lidar.measure(world, flight, i, kOneThread));
    }
    std::size_t second = 0;
    for (const Point& point : scans[0].points) second += point.echo == 1;
    EXPECT_GT(second, 10U);
    EXPECT_LT(scans[0].points.size() - second, lidar.pattern().beams_per_scan());  // dropouts
    for (const int threads : {2, 5}) {
      const Lidar twin = make_lidar(config);
      for (const std::uint64_t i : {2U, 0U, 1U}) {
        EXPECT_TRUE(same(twin.measure(world, flight, i, Parallel(threads)), scans[i])) << threads;
      }
    }
  }
}

TEST(Returns, WithoutNoiseAllPartsTogetherAreTheGeometry) {
  const world::World world(box_mesh({-9, -8, -3}, {7, 6, 5}));
  const SwingingFlight flight(2.0);
  for (const SensorConfig& config : {mid360(), ouster()}) {
    const SensorConfig noisy = with_everything(config);
    const Lidar without_noise(noisy, make_pattern(noisy), noisy.name, 1, false);
    EXPECT_TRUE(same(without_noise.measure(world, flight, 3, kOneThread),
                     make_lidar(config).measure(world, flight, 3, kOneThread)));
  }
}

}  // namespace
}  // namespace lidarena::sensor
