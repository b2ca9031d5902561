// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/odometry/run.hpp"

#include <time.h>

#include <chrono>
#include <utility>

#include "lidarena/map/point_map.hpp"
#include "lidarena/odometry/event_record.hpp"
#include "lidarena/odometry/motion_record.hpp"
#include "lidarena/odometry/pacer.hpp"
#include "lidarena/odometry/process_memory.hpp"

namespace lidarena::odometry {

namespace {

/// CPU time of all threads of this process, s.
double cpu_seconds() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

constexpr std::size_t kScansPerProportional = 10;  // reading smaps_rollup is slow

std::uint64_t part(const std::map<std::string, std::uint64_t>& memory, const char* name) {
  const auto found = memory.find(name);
  return found == memory.end() ? 0 : found->second;
}

/// Records results and resource usage of one odometry.
class Recorder {
 public:
  Recorder(Odometry& odometry, const RunOptions& options, LogSink& log)
      : odometry_(odometry),
        options_(options),
        log_(log),
        imu_id_(options.imu_id),
        lidar_id_(options.lidar_id),
        map_(options.map_voxel_size_m) {}

  /// True for samples of the run's IMU and for scans of its LiDAR that are in time order.
  bool wants(const dataset::Event& event);
  /// Hands a wanted event to the odometry; returns the wall time that this took, s.
  double feed(const dataset::Event& event);

  bool diverged() const { return result_.summary.diverged; }
  RunSummary& summary() { return result_.summary; }
  RunResult finish();

 private:
  bool in_order(const Scan& scan);
  void keep_result(const ScanResult& result);
  void keep_resources(const Scan& scan, double latency_s);
  void diverge(const std::string& reason);

  Odometry& odometry_;
  const RunOptions& options_;
  LogSink& log_;
  std::string imu_id_;
  std::string lidar_id_;
  std::optional<Time> first_stamp_;
  Time last_stamp_{0};
  double cpu_s_ = 0.0;  // of the calls since the scan before
  std::vector<StampedPose> live_;
  MotionRecord motion_;
  EventRecord events_;
  map::PointMap map_;
  RunResult result_;
};

bool Recorder::wants(const dataset::Event& event) {
  const auto* scan = std::get_if<Scan>(&event.data);
  std::string& chosen = scan != nullptr ? lidar_id_ : imu_id_;
  if (chosen.empty()) chosen = event.sensor_id;
  return event.sensor_id == chosen && (scan == nullptr || in_order(*scan));
}

double Recorder::feed(const dataset::Event& event) {
  if (diverged()) return 0.0;
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
    events_.add(sample);
    return taken;
  }
  const ScanResult result = odometry_.register_scan(*scan);
  const double latency = seconds();
  cpu_s_ += cpu_seconds() - cpu_start_s;
  events_.add(*scan, result);
  keep_result(result);
  keep_resources(*scan, latency);
  log_.progress("run", static_cast<double>(summary().scans),
                static_cast<double>(options_.scan_count.value_or(0)));
  return latency;
}

bool Recorder::in_order(const Scan& scan) {
  if (!first_stamp_)
    first_stamp_ = scan.stamp;
  else if (scan.stamp <= last_stamp_) {
    log_.warn("skipped a scan that is not later than the one before it");
    return false;
  }
  last_stamp_ = scan.stamp;
  return true;
}

void Recorder::keep_result(const ScanResult& result) {
  ++summary().scans;
  ++summary().statuses[result.status];
  if (result.status == ScanStatus::kDiverged) return diverge("the algorithm reported divergence");
  const StampedPose& estimate = result.estimate;
  if (!estimate.world_from_body.matrix().allFinite()) return diverge("a pose is not finite");
  if (!live_.empty() && estimate.stamp <= live_.back().stamp)
    return log_.warn("skipped an estimate that is not later than the one before it");
  live_.push_back(estimate);
  motion_.add(result);
  const OdometryTraits traits = odometry_.traits();
  if (!traits.publishes_scans) return;
  if (traits.gravity_aligned) {  // its world may still change
    map_.insert(transformed(odometry_.world_from_start().inverse(), odometry_.registered_scan()));
  } else {
    map_.insert(odometry_.registered_scan());
  }
}

void Recorder::keep_resources(const Scan& scan, double latency_s) {
  auto& rows = result_.files.resources;
  const auto memory = odometry_.memory();
  dataset::ResourceRow row;
  row.t_sensor_s = to_seconds(end_of(scan) - *first_stamp_);
  row.latency_s = latency_s;
  row.cpu_s = std::exchange(cpu_s_, 0.0);
  row.rss_bytes = resident_bytes();
  row.pss_bytes = rows.size() % kScansPerProportional == 0 ? proportional_bytes().value_or(0)
                                                           : rows.back().pss_bytes;
  row.map_bytes = part(memory, "map");
  row.scan_buffer_bytes = part(memory, "scan_buffer");
  row.backlog_bytes = part(memory, "backlog");
  rows.push_back(row);
  summary().sensor_seconds = row.t_sensor_s;
  summary().compute_seconds += latency_s;
}

void Recorder::diverge(const std::string& reason) {
  summary().diverged = true;
  summary().reason = "scan " + std::to_string(summary().scans - 1) + ": " + reason;
  log_.warn("diverged at " + summary().reason);
}

RunResult Recorder::finish() {
  dataset::RunFiles& files = result_.files;
  files.live = Trajectory(live_, "live estimates");
  if (diverged()) {
    files.trajectory = files.live;  // after divergence the algorithm's own may be invalid
  } else {
    odometry_.finish();
    files.trajectory = odometry_.trajectory();
  }
  files.motion = motion_.along(files.trajectory);
  files.events = events_.events(first_stamp_.value_or(Time{0}));
  files.map.points = odometry_.traits().publishes_scans
                         ? transformed(odometry_.world_from_start(), map_.take())
                         : odometry_.map();
  return std::move(result_);
}

}  // namespace

RunResult run(Odometry& odometry, dataset::EventSource& events, const RunOptions& options,
              LogSink& log) {
  Recorder recorder(odometry, options, log);
  Pacer pacer([&](const dataset::Event& event) { return recorder.feed(event); });
  while (!recorder.diverged()) {
    std::optional<dataset::Event> event = events.next();
    if (!event) break;
    if (!recorder.wants(*event)) continue;
    if (options.paced) {
      pacer.offer(std::move(*event));
    } else {
      recorder.feed(*event);
    }
  }
  pacer.flush();
  recorder.summary().dropped = pacer.dropped();
  recorder.summary().longest_delay_s = pacer.longest_delay_s();
  return recorder.finish();
}

}  // namespace lidarena::odometry
