// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/odometry/run.hpp"

#include <time.h>

#include <chrono>
#include <utility>

#include "lidarena/odometry/pacer.hpp"

namespace lidarena::odometry {

namespace {

/// CPU time of all threads of this process, s.
double cpu_seconds() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/// Hands events to one odometry and measures what each takes.
class Feeder {
 public:
  Feeder(Odometry& odometry, const RunOptions& options, RunObserver& observer, LogSink& log)
      : odometry_(odometry),
        observer_(observer),
        log_(log),
        imu_id_(options.imu_id),
        lidar_id_(options.lidar_id),
        scan_count_(options.scan_count.value_or(0)) {}

  /// True for samples of the run's IMU and for scans of its LiDAR.
  bool wants(const Event& event);
  /// Hands a wanted event to the odometry; returns the wall time that this took, s.
  double feed(const Event& event);

  RunSummary& summary() { return summary_; }

 private:
  void note(const Scan& scan, const ScanResult& result, double latency_s);
  void diverge(const std::string& reason);

  Odometry& odometry_;
  RunObserver& observer_;
  LogSink& log_;
  std::string imu_id_;
  std::string lidar_id_;
  std::size_t scan_count_;
  std::optional<Time> first_stamp_;
  double cpu_s_ = 0.0;  // of the calls since the scan before
  RunSummary summary_;
};

bool Feeder::wants(const Event& event) {
  const auto* scan = std::get_if<Scan>(&event.data);
  std::string& chosen = scan != nullptr ? lidar_id_ : imu_id_;
  if (chosen.empty()) chosen = event.sensor_id;
  return event.sensor_id == chosen;
}

double Feeder::feed(const Event& event) {
  if (summary_.diverged) return 0.0;
  const double cpu_start_s = cpu_seconds();
  const auto start = std::chrono::steady_clock::now();
  const auto seconds = [&start] {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  };
  const auto* scan = std::get_if<Scan>(&event.data);
  if (scan == nullptr) {
    const auto& sample = std::get<ImuSample>(event.data);
    odometry_.register_imu(sample);
    cpu_s_ += cpu_seconds() - cpu_start_s;
    const double taken = seconds();
    observer_.take(sample);
    return taken;
  }
  const ScanResult result = odometry_.register_scan(*scan);
  const double latency = seconds();
  cpu_s_ += cpu_seconds() - cpu_start_s;
  if (result.status == ScanStatus::kRefused) {
    ++summary_.refused;
    log_.warn("skipped a scan that is not later than the one before it");
    return latency;
  }
  note(*scan, result, latency);
  observer_.take(*scan, result, {latency, std::exchange(cpu_s_, 0.0)});
  log_.progress("run", static_cast<double>(summary_.scans), static_cast<double>(scan_count_));
  return latency;
}

void Feeder::note(const Scan& scan, const ScanResult& result, double latency_s) {
  if (!first_stamp_) first_stamp_ = scan.stamp;
  ++summary_.scans;
  ++summary_.statuses[result.status];
  summary_.sensor_seconds = to_seconds(end_of(scan) - *first_stamp_);
  summary_.compute_seconds += latency_s;
  if (result.status == ScanStatus::kDiverged) return diverge("the algorithm reported divergence");
  if (!result.estimate.world_from_body.matrix().allFinite()) diverge("a pose is not finite");
}

void Feeder::diverge(const std::string& reason) {
  summary_.diverged = true;
  summary_.reason = "scan " + std::to_string(summary_.scans - 1) + ": " + reason;
  log_.warn("diverged at " + summary_.reason);
}

}  // namespace

RunSummary run(Odometry& odometry, EventSource& events, const RunOptions& options,
               RunObserver& observer, LogSink& log) {
  Feeder feeder(odometry, options, observer, log);
  Pacer pacer([&](const Event& event) { return feeder.feed(event); });
  while (!feeder.summary().diverged) {
    std::optional<Event> event = events.next();
    if (!event) break;
    if (!feeder.wants(*event)) continue;
    if (options.paced) {
      pacer.offer(std::move(*event));
    } else {
      feeder.feed(*event);
    }
  }
  pacer.flush();
  if (!feeder.summary().diverged) odometry.finish();
  feeder.summary().dropped = pacer.dropped();
  feeder.summary().longest_delay_s = pacer.longest_delay_s();
  return feeder.summary();
}

}  // namespace lidarena::odometry
