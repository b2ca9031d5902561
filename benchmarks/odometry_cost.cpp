// SPDX-License-Identifier: BSD-3-Clause
// Cost of an odometry: CPU time of its calls (of all threads of the process; reading happens
// between the calls and is not counted), memory by part, statuses. Usage:
//   odometry_cost ALGORITHM[:PRESET] DATASET [--out FILE.tum] [--sensor ID] [--threads N]
//                 [KEY=VALUE ...] [faults: see faults.hpp]
// The estimate's stamps are those of the recording, also with a fault of the scans' clock.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <ctime>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "benchmarks/faults.hpp"
#include "lidarena/base/error.hpp"
#include "lidarena/dataset/trajectories/tum.hpp"
#include "lidarena/odometry/factory.hpp"
#include "lidarena/stages/process_memory.hpp"
#include "lidarena/stages/simulate_dataset.hpp"

namespace lidarena {
namespace {

struct Arguments {
  odometry::OdometryRequest odometry;
  std::string dataset, out, sensor;
  int threads = 1;
  Faults faults;
};

Arguments parsed(const std::vector<std::string>& words) {
  Arguments a;
  std::vector<std::string> places;
  for (std::size_t i = 0; i < words.size(); ++i) {
    const auto value = [&] { return i + 1 < words.size() ? words[++i] : std::string(); };
    if (words[i] == "--out") {
      a.out = value();
    } else if (words[i] == "--sensor") {
      a.sensor = value();
    } else if (words[i] == "--threads") {
      a.threads = std::stoi(value());
    } else if (i + 1 < words.size() && read_fault(words[i], words[i + 1], a.faults)) {
      ++i;
    } else if (words[i].find('=') != std::string::npos) {
      a.odometry.overrides.push_back(words[i]);
    } else {
      places.push_back(words[i]);
    }
  }
  if (places.size() != 2) {
    throw InputError("arguments", "two are needed",
                     "give ALGORITHM or ALGORITHM:PRESET, and DATASET");
  }
  const std::size_t colon = places[0].find(':');
  a.odometry.algorithm = places[0].substr(0, colon);
  if (colon != std::string::npos) a.odometry.preset = places[0].substr(colon + 1);
  a.dataset = places[1];
  return a;
}

double cpu_seconds() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

double percentile(std::vector<double> values, double share) {
  std::sort(values.begin(), values.end());
  return values[static_cast<std::size_t>(share * static_cast<double>(values.size() - 1))];
}

constexpr std::size_t kStateEvery = 600;  // scans

/// Prints the CPU time of the last scans, and the memory by part.
void print_state(const std::vector<double>& scan_ms, const odometry::Odometry& odometry) {
  const std::size_t count = std::min(scan_ms.size(), kStateEvery);
  const std::vector<double> last(scan_ms.end() - static_cast<std::ptrdiff_t>(count), scan_ms.end());
  if (last.empty()) return;
  fmt::print("scan {}: CPU ms of the last {}: median {:.2f}, P99 {:.2f}, max {:.2f}; rss {:.1f} MB",
             scan_ms.size(), count, percentile(last, 0.5), percentile(last, 0.99),
             percentile(last, 1.0), 1e-6 * static_cast<double>(stages::resident_bytes()));
  const odometry::MemoryUse memory = odometry.memory();
  fmt::print(", map {:.3f}, scan buffer {:.3f}, backlog {:.3f}, other {:.3f}",
             1e-6 * static_cast<double>(memory.map), 1e-6 * static_cast<double>(memory.scan_buffer),
             1e-6 * static_cast<double>(memory.backlog), 1e-6 * static_cast<double>(memory.other));
  fmt::print("\n");
  std::fflush(stdout);
}

int measure(const Arguments& a) {
  const Parallel parallel(a.threads);
  dataset::ReadOptions read;
  read.sensor = a.sensor;
  dataset::Dataset dataset = stages::open_any_dataset(a.dataset, read, parallel);
  const LidarInfo* lidar = dataset.rig.find_lidar(a.sensor);
  if (lidar == nullptr) throw InputError(a.dataset, "has several LiDARs", "choose with --sensor");
  const ImuInfo* imu = dataset.rig.imu_beside(*lidar);
  const auto odometry =
      odometry::make_odometry(a.odometry, with_faults(dataset.rig, a.faults), lidar->id, parallel)
          .odometry;
  std::vector<double> scan_ms;
  std::optional<Time> first;
  odometry::ScanDetails last;
  double between = 0.0;  // CPU time of the IMU calls before the next scan, s
  std::map<std::string, std::size_t> statuses;
  std::map<std::string, double> sums;
  double min_inlier_share = 1.0;  // of a scan with the map, if the algorithm counts it
  while (const auto event = dataset.events->next()) {
    const auto* scan = std::get_if<Scan>(&event->data);
    if (event->sensor_id != (scan != nullptr || imu == nullptr ? lidar->id : imu->id)) continue;
    if (scan != nullptr && !first) first = scan->stamp;
    const Scan faulty =
        scan == nullptr ? Scan{} : with_faults(*scan, to_seconds(scan->stamp - *first), a.faults);
    const double start = cpu_seconds();
    if (scan == nullptr) {
      odometry->register_imu(std::get<ImuSample>(event->data));
      between += cpu_seconds() - start;
      continue;
    }
    const odometry::ScanResult result = odometry->register_scan(faulty);
    scan_ms.push_back(1e3 * (between + cpu_seconds() - start));
    between = 0.0;
    ++statuses[odometry::to_string(result.status)];
    last = result.details;
    for (const auto& [name, value] : last) sums[name] += value;
    if (const double near = result.detail("near_planes").value_or(0.0); near > 0.0)
      min_inlier_share = std::min(min_inlier_share, result.detail("matches").value_or(0.0) / near);
    if (scan_ms.size() % kStateEvery == 0) print_state(scan_ms, *odometry);
  }
  odometry->finish();
  print_state(scan_ms, *odometry);
  double total = 0.0;
  for (const double ms : scan_ms) total += ms;
  const auto count = static_cast<double>(scan_ms.size());
  fmt::print("CPU ms a scan: mean {:.2f}, median {:.2f}, P95 {:.2f}, P99 {:.2f}, max {:.2f}\n",
             total / count, percentile(scan_ms, 0.5), percentile(scan_ms, 0.95),
             percentile(scan_ms, 0.99), percentile(scan_ms, 1.0));
  fmt::print("statuses: {}\nmeans:", statuses);
  for (const auto& [name, sum] : sums) fmt::print(" {} {:.4g}", name, sum / count);
  fmt::print("\nminimum agreement of a scan with the map: {:.3f}\n", min_inlier_share);
  fmt::print("last scan:");
  for (const auto& [name, value] : last) fmt::print(" {} {}", name, value);
  fmt::print("\n");
  const Trajectory estimated = odometry->trajectory();
  std::vector<StampedPose> poses(estimated.poses().begin(), estimated.poses().end());
  for (StampedPose& pose : poses) pose.stamp -= a.faults.clock;
  if (!a.out.empty()) dataset::write_tum(a.out, Trajectory(std::move(poses), a.out), "");
  return 0;
}

}  // namespace
}  // namespace lidarena

int main(int argc, char** argv) {
  try {
    return lidarena::measure(lidarena::parsed({argv + 1, argv + argc}));
  } catch (const std::exception& error) {
    fmt::print(stderr, "odometry_cost: {}\n", error.what());
    return 2;
  }
}
