// SPDX-License-Identifier: BSD-3-Clause
// Cost of a simulated scan compared with the bare ray-casting calls for the same rays, in a closed
// world of a million triangles. Each row alternates the two, so that other load affects both:
//   bare, measured  shots per second of CPU time (bare: with prepared packets, hits are not used)
//   of_bare         measured / bare
//   real_time       scan period / wall time of a measured scan; meaningful on an idle machine
// The rows simulate/... do the same for a complete simulation: flight, IMU, scans and recording as
// MCAP in our layout (24 bytes per point) or in that of the sensor's driver.
#include <benchmark/benchmark.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <memory>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "benchmarks/bare_scene.hpp"
#include "lidarena/dataset/dataset.hpp"
#include "lidarena/flight/flight_config.hpp"
#include "lidarena/flight/spline_flight.hpp"
#include "lidarena/sensor/imu.hpp"
#include "lidarena/sensor/lidar.hpp"
#include "lidarena/sensor/lidar_motion.hpp"
#include "lidarena/sensor/simulate.hpp"
#include "lidarena/world/living_world.hpp"
#include "lidarena/world/world.hpp"

namespace lidarena {
namespace {

using Eigen::Vector3d;

constexpr std::size_t kPacketSize = sensor::CastOrder::kPacketSize;

/// A closed room of 1,001,112 triangles, 40 m by 26 m by 8 m, with bumps of all sizes.
world::TriangleMesh bumpy_room() {
  constexpr int kAround = 708, kUp = 708;
  world::TriangleMesh mesh;
  for (int j = 0; j <= kUp; ++j) {
    for (int i = 0; i < kAround; ++i) {
      const double a = 2.0 * std::numbers::pi * i / kAround;
      const double b = std::numbers::pi * (static_cast<double>(j) / kUp - 0.5);
      const double r = 10.0 + 1.5 * std::sin(7 * a) * std::cos(5 * b) +
                       0.5 * std::sin(31 * a + 3) * std::sin(23 * b) +
                       0.05 * std::sin(211 * a) * std::cos(197 * b);
      mesh.vertices.emplace_back(2.0 * r * std::cos(b) * std::cos(a),
                                 1.3 * r * std::cos(b) * std::sin(a), 0.4 * r * std::sin(b));
    }
  }
  const auto at = [](int j, int i) {
    return static_cast<std::uint32_t>(j * kAround + i % kAround);
  };
  for (int j = 0; j < kUp; ++j) {
    for (int i = 0; i < kAround; ++i) {
      mesh.triangles.push_back({at(j, i), at(j + 1, i + 1), at(j, i + 1)});
      mesh.triangles.push_back({at(j, i), at(j + 1, i), at(j + 1, i + 1)});
    }
  }
  return mesh;
}

/// Inputs of all rows, created once.
struct Stage {
  world::TriangleMesh mesh = bumpy_room();
  BareScene bare{mesh};
  world::World world{mesh};
  flight::SplineFlight flight = make_flight();

  static flight::SplineFlight make_flight() {
    flight::FlightConfig config;
    config.style = flight::FlightStyle::kAggressive;
    const std::vector<Vector3d> tour{{-9, -4, 0}, {9, -4, 1}, {9, 4, 0}, {-9, 4, 1}, {-9, -4, 0}};
    return flight::SplineFlight(tour, config, "benchmark");
  }
  static const Stage& get() {
    static const Stage stage;
    return stage;
  }
};

enum Sensor { kMid360, kOs0 };
enum Effects {
  kGeometry,
  kFrozen,
  kRangeNoise,
  kSheet,
  kSplitBeam,
  kBias,
  kClock,
  kShake,
  kDrift,
  kAir,
  kBounces,
  kBlooming,
  kMovers,
  kHarsh  // bias, clock, drift, shaking and movers together
};

sensor::SensorConfig config_of(Sensor sensor, Effects effects) {
  sensor::SensorConfig config;
  config.name = sensor == kOs0 ? "os0" : "mid360";
  config.model =
      sensor == kOs0 ? sensor::LidarModel::kOusterOs0128 : sensor::LidarModel::kLivoxMid360;
  config.columns = sensor == kOs0 ? 2048 : 0;
  config.max_range_m = 100.0;
  if (effects == kFrozen) config.mode = sensor::ScanMode::kFrozen;
  if (effects >= kRangeNoise) config.range_noise_m = 0.02;
  if (effects >= kSheet) {
    config.noise.near_range_noise_m = 0.03;
    config.noise.angle_noise_deg = 0.1;
    config.noise.range_step_m = 0.001;
    config.noise.weak_signal_noise = true;
    config.noise.dropouts = true;
    config.noise.signal = {.range_at_10_m = 40.0, .range_at_80_m = 70.0};
  }
  if (effects == kSplitBeam) {
    config.noise.beam = {.sub_rays = 7, .width_deg = 0.35, .height_deg = 0.35};
    config.returns.count = 2;
  }
  const bool harsh = effects == kHarsh;
  if (effects == kBias || harsh) config.noise.bias = {0.01, 0.01, 0.01, 0.01, 0.01};
  if (effects == kClock || harsh) config.noise.clock = {0.001, 1e-5, 1e-4, true};
  if (effects == kDrift || harsh) config.noise.drift = {0.02, 0.0, 0.001, 10.0, 1200.0};
  if (effects == kAir) {
    config.noise.air = {.visibility_m = 200.0, .rain_mm_h = 10.0};
    config.noise.beam.width_deg = config.noise.beam.height_deg = 0.2;
  }
  if (effects == kBounces) config.noise.bounces = 2;
  if (effects == kBlooming) config.noise.blooming = {0.005, 1.5, 8};
  if (effects == kShake || harsh) {
    sensor::ImuConfig& imu = config.imu.emplace();
    imu.vibration_moves_lidar = true;
    imu.broadband.accel_rms = {2, 2, 2};
    imu.broadband.gyro_rms = {0.02, 0.02, 0.02};
  }
  return config;
}

/// The rays of a scan in the lidar's order of casting, as prepared packets.
std::vector<RTCRayHit8> packets_of(const sensor::Lidar& lidar, const sensor::SensorConfig& config,
                                   std::uint64_t index) {
  const Stage& stage = Stage::get();
  std::vector<sensor::Beam> beams;
  lidar.pattern().beams(index, beams);
  const sensor::CastOrder order(beams);
  std::vector<RTCRayHit8> packets(beams.size() / kPacketSize);
  for (std::size_t i = 0; i < beams.size(); ++i) {
    const Time dt{config.mode == sensor::ScanMode::kRolling ? beams[i].dt_ns : 0};
    const Pose pose = stage.flight.pose_at(lidar.stamp(index) + dt) * config.body_from_lidar;
    const Eigen::Vector3f origin = (pose * beams[i].origin.cast<double>()).cast<float>();
    const Eigen::Vector3f direction =
        (pose.linear() * beams[i].direction.cast<double>()).cast<float>();
    const std::size_t place = order.place(i, beams.size());
    RTCRayHit8& packet = packets[place / kPacketSize];
    const std::size_t lane = place % kPacketSize;
    packet.ray.org_x[lane] = origin.x();
    packet.ray.org_y[lane] = origin.y();
    packet.ray.org_z[lane] = origin.z();
    packet.ray.dir_x[lane] = direction.x();
    packet.ray.dir_y[lane] = direction.y();
    packet.ray.dir_z[lane] = direction.z();
    packet.ray.tnear[lane] = 0.0F;
    packet.ray.tfar[lane] = static_cast<float>(config.max_range_m);
    packet.ray.mask[lane] = std::numeric_limits<unsigned>::max();
    packet.ray.flags[lane] = 0;
    packet.ray.time[lane] = 0.0F;
    packet.hit.geomID[lane] = RTC_INVALID_GEOMETRY_ID;
    packet.hit.instID[0][lane] = RTC_INVALID_GEOMETRY_ID;
  }
  return packets;
}

double processor_seconds() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/// Minimum time of several runs, which reduces the effect of disturbances.
struct Stopwatch {
  double processor_s = 1e9, wall_s = 1e9;

  template <class Run>
  void time(Run&& run) {
    const auto wall = std::chrono::steady_clock::now();
    const double processor = processor_seconds();
    run();
    processor_s = std::min(processor_s, processor_seconds() - processor);
    const std::chrono::duration<double> took = std::chrono::steady_clock::now() - wall;
    wall_s = std::min(wall_s, took.count());
  }
};

void cast_bare(const std::vector<RTCRayHit8>& packets, const Parallel& parallel) {
  parallel.for_each(packets.size(), 128, [&](std::size_t i) {
    RTCRayHit8 packet = packets[i];
    Stage::get().bare.intersect(packet);
    benchmark::DoNotOptimize(packet);
  });
}

std::vector<world::MoverConfig> five_people() {
  std::vector<world::MoverConfig> people(5);
  for (std::size_t i = 0; i < people.size(); ++i)
    people[i].path = {{3.0 * static_cast<double>(i) - 6.0, 2, -3}, {0, -2, -3}};
  return people;
}

/// The room with a wet floor (the lowest eighth of its rows) and 1,416 triangles of signs.
const world::World& glossy_room() {
  static const world::World world = [] {
    world::TriangleMesh mesh = Stage::get().mesh;
    const std::size_t wet = mesh.triangles.size() / 8, row = 2 * 708;
    mesh.palette = {world::Material{}, world::materials::kWetFloor, world::materials::kSign};
    mesh.material_ids.assign(mesh.triangles.size(), 0);
    std::fill_n(mesh.material_ids.begin(), wet, std::uint8_t{1});
    std::fill_n(mesh.material_ids.begin() + static_cast<std::ptrdiff_t>(4 * wet), row,
                std::uint8_t{2});
    return world::World(std::move(mesh));
  }();
  return world;
}

const world::Surfaces& world_for(Effects effects, const world::Surfaces& living) {
  if (effects == kMovers || effects == kHarsh) return living;
  return effects == kBounces || effects == kBlooming ? glossy_room() : Stage::get().world;
}

void measure(benchmark::State& state, Sensor sensor, Effects effects) {
  const Stage& stage = Stage::get();
  const Parallel parallel(static_cast<int>(state.range(0)));
  const sensor::SensorConfig config = config_of(sensor, effects);
  const sensor::Lidar lidar(config, sensor::make_pattern(config), config.name, 1, true);
  // Always the same scan in mid-flight; caches between scans are filled after the first run.
  const std::uint64_t index = static_cast<std::uint64_t>(to_seconds(stage.flight.duration()) * 4.0);
  const auto packets = packets_of(lidar, config, index);
  const world::LivingWorld living(stage.world, five_people());
  const world::Surfaces& world = world_for(effects, living);
  Stopwatch bare, measured;
  for (auto _ : state) {
    bare.time([&] { cast_bare(packets, parallel); });
    measured.time(
        [&] { benchmark::DoNotOptimize(lidar.measure(world, stage.flight, index, parallel)); });
  }
  const auto shots = static_cast<double>(packets.size() * kPacketSize);
  state.counters["bare"] = shots / bare.processor_s;
  state.counters["measured"] = shots / measured.processor_s;
  state.counters["of_bare"] = bare.processor_s / measured.processor_s;
  state.counters["real_time"] = to_seconds(lidar.pattern().period()) / measured.wall_s;
}

constexpr int kRuns = 25;  // runs per row, of which the minimum time is reported

void register_rows() {
  const std::pair<const char*, Sensor> sensors[] = {{"mid360", kMid360}, {"os0_128_2048", kOs0}};
  const std::pair<const char*, Effects> effects[] = {
      {"geometry", kGeometry},      {"frozen", kFrozen},
      {"range_noise", kRangeNoise}, {"sheet", kSheet},
      {"split_beam", kSplitBeam},   {"sheet_bias", kBias},
      {"sheet_clock", kClock},      {"sheet_shake", kShake},
      {"sheet_movers", kMovers},    {"sheet_drift", kDrift},
      {"sheet_air", kAir},          {"sheet_bounces", kBounces},
      {"sheet_blooming", kBlooming}, {"sheet_harsh", kHarsh}};
  for (const auto& sensor : sensors) {
    for (const auto& effect : effects) {
      const std::string name = std::string("measure/") + sensor.first + "/" + effect.first;
      benchmark::RegisterBenchmark(name.c_str(), measure, sensor.second, effect.second)
          ->ArgName("threads")
          ->Arg(1)
          ->Arg(2)
          ->Iterations(kRuns)
          ->UseRealTime()
          ->Unit(benchmark::kMillisecond);
    }
  }
}
[[maybe_unused]] const bool kRegistered = (register_rows(), true);

/// Three seconds of flight, written to a file. Bare calls: every fifth scan, five times.
void simulate_to_file(benchmark::State& state, Sensor sensor, Effects effects,
                      dataset::Dialect dialect) {
  namespace fs = std::filesystem;
  constexpr std::uint64_t kEvery = 5;
  const Stage& stage = Stage::get();
  const Parallel parallel(static_cast<int>(state.range(0)));
  sensor::SensorConfig config = config_of(sensor, effects);
  config.imu.emplace();
  sensor::SimulationOptions options;
  options.duration = std::chrono::seconds(3);
  std::string name = (fs::temp_directory_path() / "lidarena_benchmark_XXXXXX").string();
  const fs::path folder = ::mkdtemp(name.data());

  const sensor::Lidar lidar(config, sensor::make_pattern(config), config.name, 1, true);
  const auto scans = static_cast<std::uint64_t>(options.duration / lidar.pattern().period());
  std::vector<std::vector<RTCRayHit8>> packets;
  for (std::uint64_t i = 0; i < scans; i += kEvery) packets.push_back(packets_of(lidar, config, i));
  Stopwatch bare, simulated;
  std::size_t points = 0;
  for (auto _ : state) {
    bare.time([&] {
      for (const auto& scan : packets) {
        for (std::uint64_t i = 0; i < kEvery; ++i) cast_bare(scan, parallel);
      }
    });
    points = 0;
    simulated.time([&] {
      dataset::DatasetWriter out(folder, sensor::make_rig({config}),
                                 {dataset::DatasetFormat::kMcap, dialect});
      const auto events = sensor::simulate(stage.world, stage.flight, {config}, options, parallel);
      while (const auto event = events->next()) {
        if (const auto* scan = std::get_if<Scan>(&event->data)) points += scan->points.size();
        out.write(*event);
      }
      out.close();
    });
  }
  const auto shots = static_cast<double>(scans * packets[0].size() * kPacketSize);
  const auto bytes = static_cast<double>(fs::file_size(folder / "data.mcap"));
  fs::remove_all(folder);
  state.counters["bare"] = shots / bare.processor_s;
  state.counters["simulated"] = shots / simulated.processor_s;
  state.counters["of_bare"] = bare.processor_s / simulated.processor_s;
  state.counters["stored/point"] = bytes / static_cast<double>(points);
}

void register_simulations() {
  const std::pair<const char*, Sensor> sensors[] = {{"mid360", kMid360}, {"os0_128_2048", kOs0}};
  const std::pair<const char*, Effects> effects[] = {{"geometry", kGeometry},
                                                     {"range_noise", kRangeNoise}};
  const std::pair<const char*, dataset::Dialect> dialects[] = {
      {"si", dataset::Dialect::kSi}, {"driver", dataset::Dialect::kDriver}};
  for (const auto& sensor : sensors) {
    for (const auto& effect : effects) {
      for (const auto& dialect : dialects) {
        const std::string name =
            std::string("simulate/") + sensor.first + "/" + effect.first + "/" + dialect.first;
        benchmark::RegisterBenchmark(name.c_str(), simulate_to_file, sensor.second, effect.second,
                                     dialect.second)
            ->ArgName("threads")
            ->Arg(1)
            ->Iterations(3)
            ->UseRealTime()
            ->Unit(benchmark::kMillisecond);
      }
    }
  }
}
[[maybe_unused]] const bool kSimulationsRegistered = (register_simulations(), true);

/// Parts of a scan other than ray casting, on one thread.
void pattern(benchmark::State& state, Sensor sensor) {
  const auto made = sensor::make_pattern(config_of(sensor, kGeometry));
  std::vector<sensor::Beam> beams;
  std::uint64_t index = 0;
  for (auto _ : state) made->beams(index++, beams);
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(beams.size()));
}
BENCHMARK_CAPTURE(pattern, mid360, kMid360)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(pattern, os0, kOs0)->Unit(benchmark::kMillisecond);

void motion(benchmark::State& state) {
  const Stage& stage = Stage::get();
  for (auto _ : state) {
    benchmark::DoNotOptimize(sensor::LidarMotion(stage.flight, Pose::Identity(),
                                                 std::chrono::seconds(2), 99'995'000, true));
  }
}
BENCHMARK(motion)->Unit(benchmark::kMillisecond);

/// A second of an IMU at 200 Hz.
enum ImuEffects { kIdeal, kImuSheet, kBandwidth, kBroadband, kDistortion, kTiming };
void imu_second(benchmark::State& state, ImuEffects effects) {
  sensor::ImuConfig config;
  config.gyro_noise_density = 1e-4;
  config.accel_noise_density = 1e-3;
  if (effects == kBandwidth) config.bandwidth_hz = 100.0;
  if (effects == kBroadband) config.broadband.accel_rms = {2, 2, 2};
  if (effects == kDistortion) config.gyro_g_sensitivity = 1e-4;
  if (effects == kTiming) config.stamp_jitter_s = config.delay_s = config.lost_share = 0.001;
  sensor::Imu imu(config, Pose::Identity(), "imu", 1, effects != kIdeal);
  for (auto _ : state) {
    for (int i = 0; i < 200; ++i) benchmark::DoNotOptimize(imu.measure(Stage::get().flight));
  }
}
BENCHMARK_CAPTURE(imu_second, ideal, kIdeal)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(imu_second, sheet, kImuSheet)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(imu_second, bandwidth, kBandwidth)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(imu_second, broadband, kBroadband)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(imu_second, distortion, kDistortion)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(imu_second, timing, kTiming)->Unit(benchmark::kMillisecond);

/// Comparison of bare calls: single rays, and packets of eight rays in casting order.
void bare_one_by_one(benchmark::State& state, Sensor sensor) {
  const sensor::SensorConfig config = config_of(sensor, kGeometry);
  const sensor::Lidar lidar(config, sensor::make_pattern(config), config.name, 1, true);
  const auto packets = packets_of(lidar, config, 20);
  RTCRayHit query{};
  for (auto _ : state) {
    for (const RTCRayHit8& packet : packets) {
      for (std::size_t lane = 0; lane < kPacketSize; ++lane) {
        query.ray = rtcGetRayFromRayN(reinterpret_cast<RTCRayN*>(const_cast<RTCRay8*>(&packet.ray)),
                                      8, static_cast<unsigned>(lane));
        query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
#if LIDARENA_EMBREE_MAJOR >= 4
        rtcIntersect1(Stage::get().bare.scene, &query);
#else
        RTCIntersectContext context;
        rtcInitIntersectContext(&context);
        rtcIntersect1(Stage::get().bare.scene, &context, &query);
#endif
        benchmark::DoNotOptimize(query);
      }
    }
  }
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(packets.size() * 8));
}
BENCHMARK_CAPTURE(bare_one_by_one, mid360, kMid360)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(bare_one_by_one, os0, kOs0)->Unit(benchmark::kMillisecond);

void bare_packets(benchmark::State& state, Sensor sensor) {
  const sensor::SensorConfig config = config_of(sensor, kGeometry);
  const sensor::Lidar lidar(config, sensor::make_pattern(config), config.name, 1, true);
  const auto packets = packets_of(lidar, config, 20);
  for (auto _ : state) cast_bare(packets, Parallel(1));
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(packets.size() * 8));
}
BENCHMARK_CAPTURE(bare_packets, mid360, kMid360)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(bare_packets, os0, kOs0)->Unit(benchmark::kMillisecond);

/// Bytes per triangle: of Embree's copy and tree, and of our mesh.
void memory(benchmark::State& state) {
  const Stage& stage = Stage::get();
  for (auto _ : state) benchmark::DoNotOptimize(stage.bare.bytes);
  const auto triangles = static_cast<double>(stage.mesh.triangles.size());
  const auto vertices = static_cast<double>(stage.mesh.vertices.size());
  state.counters["triangles"] = triangles;
  state.counters["library"] = static_cast<double>(stage.bare.bytes) / triangles;
  state.counters["mesh"] = (vertices * sizeof(Vector3d) +
                            triangles * (sizeof(world::Triangle) + sizeof(Eigen::Vector3f))) /
                           triangles;
}
BENCHMARK(memory);

}  // namespace
}  // namespace lidarena
