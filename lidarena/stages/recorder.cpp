// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/stages/recorder.hpp"

#include "lidarena/stages/process_memory.hpp"

namespace lidarena::stages {
namespace {

constexpr std::size_t kScansPerProportional = 10;  // reading smaps_rollup is slow

}  // namespace

Recorder::Recorder(odometry::Odometry& odometry, LogSink& log, const MapRecord& map)
    : odometry_(odometry), log_(log), keeps_map_(map.is_kept), voxels_(map.voxel_size_m) {
  if (!map.file.empty()) map_file_.emplace(map.file, dataset::CloudWriter::Fields{});
}

void Recorder::take(const Scan& scan, const odometry::ScanResult& result,
                    const odometry::ScanCost& cost) {
  if (!first_stamp_) first_stamp_ = scan.stamp;
  events_.add(scan, result);
  keep_result(result);
  keep_resources(scan, cost);
}

void Recorder::keep_result(const odometry::ScanResult& result) {
  const StampedPose& estimate = result.estimate;
  if (result.status == odometry::ScanStatus::kDiverged ||
      !estimate.world_from_body.matrix().allFinite())
    return;
  if (!live_.empty() && estimate.stamp <= live_.back().stamp)
    return log_.warn("skipped an estimate that is not later than the one before it");
  live_.push_back(estimate);
  motion_.add(result);
  if (keeps_map_ && odometry_.traits().publishes_scans) keep_published();
}

void Recorder::keep_published() {
  const std::span<const Eigen::Vector3f> scan = odometry_.registered_scan();
  std::vector<std::uint32_t> added;
  voxels_.insert(scan, added);
  for (const std::uint32_t i : added) map_.points.push_back(scan[i]);
  if (!map_file_) return;
  map_file_->write(map_);
  map_.points.clear();
}

void Recorder::keep_resources(const Scan& scan, const odometry::ScanCost& cost) {
  const odometry::MemoryUse memory = odometry_.memory();
  dataset::ResourceRow row;
  row.t_sensor_s = to_seconds(end_of(scan) - *first_stamp_);
  row.latency_s = cost.latency_s;
  row.cpu_s = cost.cpu_s;
  row.rss_bytes = resident_bytes();
  row.pss_bytes = resources_.size() % kScansPerProportional == 0 ? proportional_bytes().value_or(0)
                                                                 : resources_.back().pss_bytes;
  row.map_bytes = memory.map;
  row.scan_buffer_bytes = memory.scan_buffer;
  row.backlog_bytes = memory.backlog;
  resources_.push_back(row);
}

dataset::RunFiles Recorder::finish(bool diverged) {
  dataset::RunFiles files;
  const Pose leveled_from_world = odometry_.leveled_from_world();
  files.live = Trajectory(std::move(live_), "live estimates");
  files.trajectory =
      transformed(leveled_from_world, diverged ? files.live : odometry_.trajectory());
  files.motion = motion_.along(files.trajectory);
  files.events = events_.events(first_stamp_.value_or(Time{0}));
  files.resources = std::move(resources_);
  if (keeps_map_ && !odometry_.traits().publishes_scans) map_.points = odometry_.map();
  if (map_file_) {
    map_file_->write(map_);
    map_file_->commit(leveled_from_world);
  } else {
    files.map.points = transformed(leveled_from_world, map_.points);
  }
  return files;
}

RunResult record_run(odometry::Odometry& odometry, EventSource& events,
                     const odometry::RunOptions& options, LogSink& log, const MapRecord& map) {
  Recorder recorder(odometry, log, map);
  RunResult result;
  result.summary = odometry::run(odometry, events, options, recorder, log);
  result.files = recorder.finish(result.summary.diverged);
  return result;
}

}  // namespace lidarena::stages
