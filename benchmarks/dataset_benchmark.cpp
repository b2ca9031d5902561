// SPDX-License-Identifier: BSD-3-Clause
// Speed of writing datasets, by format and dialect, and memory while a long one is written. The
// points are synthetic (a wall with 2 cm of noise) and compress about as well as real ones.
#include <benchmark/benchmark.h>
#include <unistd.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "lidarena/base/random.hpp"
#include "lidarena/dataset/dataset.hpp"

namespace lidarena {
namespace {

namespace fs = std::filesystem;

class ScratchFolder {
 public:
  ScratchFolder() {
    std::string name = (fs::temp_directory_path() / "lidarena_benchmark_XXXXXX").string();
    path_ = ::mkdtemp(name.data());
  }
  ~ScratchFolder() { fs::remove_all(path_); }
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;
  const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

struct Sensor {
  Rig rig;
  Scan scan;  ///< every shot has a return
};

/// `columns` firings of `rows` rays in one scan of 0.1 s; `together`: the rows of a column have the
/// same instant, as with an Ouster.
Sensor make_sensor(const std::string& model, int rows, int columns, bool together) {
  Sensor sensor;
  LidarInfo& lidar = sensor.rig.lidars.emplace_back();
  lidar.id = "lidar";
  lidar.model = model;
  lidar.rows = rows;
  lidar.columns = columns;
  if (together) lidar.pixel_shifts.assign(static_cast<std::size_t>(rows), 0);
  sensor.rig.imus.emplace_back().id = "lidar";
  SequentialRandom random(1);
  for (int i = 0; i < rows * columns; ++i) {
    const int firing = together ? i / rows * rows : i;
    const double turn = static_cast<double>(firing) / (rows * columns);
    const double azimuth = 2.0 * M_PI * turn;
    const double range = 5.0 + 2.0 * std::sin(3.0 * azimuth) + 0.02 * random.normal();
    const double up = 0.01 * (i % rows);
    Point point;
    point.position =
        Eigen::Vector3d(range * std::cos(azimuth), range * std::sin(azimuth), up).cast<float>();
    point.intensity = static_cast<float>(40 + i % 7);
    point.dt_ns = static_cast<std::int32_t>(std::llround(turn * 1e8));
    point.ring = static_cast<std::uint16_t>(i % rows);
    sensor.scan.points.push_back(point);
  }
  return sensor;
}

Sensor mid360() { return make_sensor("livox_mid360", 4, 5000, false); }
Sensor os0_128() { return make_sensor("ouster_os0_128", 128, 1024, true); }

std::uintmax_t bytes_in(const fs::path& folder) {
  std::uintmax_t bytes = 0;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (entry.is_regular_file()) bytes += entry.file_size();
  }
  return bytes;
}

/// Writes 20 scans per iteration; reports points, bytes in memory (24 per point) and bytes on disk
/// per second of CPU time.
void write_scans(benchmark::State& state, Sensor (*make)(), dataset::DatasetFormat format,
                 dataset::Dialect dialect) {
  constexpr int kScans = 20;
  const Sensor sensor = make();
  std::uintmax_t stored = 0;
  std::size_t points = 0;
  for (auto _ : state) {
    state.PauseTiming();
    const ScratchFolder folder;
    state.ResumeTiming();
    dataset::DatasetWriter out(folder.path(), sensor.rig, {.format = format, .dialect = dialect});
    Scan scan = sensor.scan;
    for (int i = 0; i < kScans; ++i) {
      scan.stamp = i * std::chrono::milliseconds(100);
      out.write(Event{"lidar", scan});
      points += scan.points.size();
    }
    out.close();
    state.PauseTiming();
    stored += bytes_in(folder.path());
    state.ResumeTiming();
  }
  using benchmark::Counter;
  state.counters["points/s"] = Counter(static_cast<double>(points), Counter::kIsRate);
  state.counters["MB/s in"] = Counter(24e-6 * static_cast<double>(points), Counter::kIsRate);
  state.counters["MB/s out"] = Counter(1e-6 * static_cast<double>(stored), Counter::kIsRate);
  state.counters["B/point"] = static_cast<double>(stored) / static_cast<double>(points);
}

#define LIDARENA_WRITE(sensor, format, dialect)                                \
  BENCHMARK_CAPTURE(write_scans, sensor##_##format##_##dialect, sensor,        \
                    dataset::DatasetFormat::format, dataset::Dialect::dialect) \
      ->Unit(benchmark::kMillisecond)
LIDARENA_WRITE(mid360, kMcap, kSi);
LIDARENA_WRITE(mid360, kMcap, kDriver);
LIDARENA_WRITE(mid360, kBag, kSi);
LIDARENA_WRITE(mid360, kPcd, kSi);
LIDARENA_WRITE(os0_128, kMcap, kSi);
LIDARENA_WRITE(os0_128, kMcap, kDriver);
LIDARENA_WRITE(os0_128, kBag, kDriver);

/// Resident memory of this process, MB.
double resident_mb() {
  std::ifstream status("/proc/self/statm");
  double total = 0.0;
  double resident = 0.0;
  status >> total >> resident;
  return resident * static_cast<double>(::sysconf(_SC_PAGESIZE)) * 1e-6;
}

/// Ten minutes of a Mid-360: 200,000 points/s, IMU at 200 Hz, truth at 1 kHz. "grown MB" is the
/// growth of the process from the tenth second to the last; "written MB" the size on disk.
void ten_minutes(benchmark::State& state, dataset::DatasetFormat format) {
  const Sensor sensor = mid360();
  for (auto _ : state) {
    const ScratchFolder folder;
    dataset::DatasetWriter out(folder.path(), sensor.rig, {.format = format});
    Scan scan = sensor.scan;
    constexpr int kMilliseconds = 600'000;
    double after_ten_seconds = 0.0;
    for (int ms = 0; ms < kMilliseconds; ++ms) {
      const Time now = std::chrono::milliseconds(ms);
      out.write_truth({now, Pose::Identity()});
      if (ms % 5 == 0) {
        out.write(Event{"lidar", ImuSample{now, Eigen::Vector3d::Zero(), {0, 0, 9.8}}});
      }
      if (ms % 100 == 99) {
        out.write(Event{"lidar", scan});
        scan.stamp += std::chrono::milliseconds(100);
      }
      if (ms == 10'000) after_ten_seconds = resident_mb();
    }
    state.counters["grown MB"] = resident_mb() - after_ten_seconds;
    state.counters["resident MB"] = resident_mb();
    out.close();
    state.counters["written MB"] = 1e-6 * static_cast<double>(bytes_in(folder.path()));
  }
}
BENCHMARK_CAPTURE(ten_minutes, mcap, dataset::DatasetFormat::kMcap)
    ->Unit(benchmark::kSecond)
    ->Iterations(1)
    ->UseRealTime();
BENCHMARK_CAPTURE(ten_minutes, bag, dataset::DatasetFormat::kBag)
    ->Unit(benchmark::kSecond)
    ->Iterations(1)
    ->UseRealTime();

}  // namespace
}  // namespace lidarena
