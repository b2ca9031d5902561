// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/stages/run_algorithm.hpp"

#include <algorithm>
#include <cmath>

#include "lidarena/base/machine.hpp"
#include "lidarena/dataset/single_lidar.hpp"
#include "lidarena/dataset/whole_part.hpp"
#include "lidarena/evaluation/map/reproject.hpp"
#include "lidarena/evaluation/map/return_store.hpp"
#include "lidarena/evaluation/map/scored_returns.hpp"
#include "lidarena/stages/merge_lidars.hpp"
#include "lidarena/stages/recorder.hpp"
#include "lidarena/stages/simulate_dataset.hpp"
#include "lidarena/stages/split_sweeps.hpp"

namespace lidarena::stages {
namespace {

namespace fs = std::filesystem;

std::string chosen_lidar(const dataset::Dataset& dataset, const std::string& requested) {
  if (const LidarInfo* lidar = dataset.rig.find_lidar(requested)) return lidar->id;
  std::vector<std::string> ids;
  std::string list;
  for (const LidarInfo& lidar : dataset.rig.lidars) {
    ids.push_back(lidar.id);
    list += (list.empty() ? "" : ", ") + lidar.id;
  }
  if (requested.empty()) {
    throw InputError(dataset.path.string(), "has several LiDARs",
                     "choose one with --sensor: " + list);
  }
  const std::string nearest = nearest_word(requested, ids);
  throw InputError(dataset.path.string(), "has no LiDAR named '" + requested + "'",
                   nearest.empty() ? "it has: " + list : "did you mean '" + nearest + "'?");
}

/// The dataset with all LiDARs that the request names.
dataset::Dataset opened(const RunRequest& request, const Parallel& parallel) {
  dataset::Dataset dataset = open_any_dataset(request.dataset, request.read, parallel);
  if (request.also.empty()) return dataset;
  const std::optional<std::size_t> scans = dataset.scan_count;
  dataset::ReadOptions read = request.read;
  read.sensor.clear();
  dataset = open_any_dataset(request.dataset, read, parallel);
  dataset.scan_count = scans;
  return dataset;
}

/// The LiDARs beside `lidar_id` that the request names.
std::vector<LidarInfo> further_lidars(const dataset::Dataset& dataset, const RunRequest& request,
                                      const std::string& lidar_id) {
  std::vector<LidarInfo> others;
  for (const std::string& name : request.also) {
    const std::string id = chosen_lidar(dataset, dataset::id_of_topic(name));
    if (id == lidar_id || std::ranges::find(others, id, &LidarInfo::id) != others.end())
      throw InputError("--also " + name, "names a LiDAR that is used already", "leave it out");
    others.push_back(*dataset.rig.find_lidar(id));
  }
  return others;
}

/// An IMU that cannot be used is an error of the methods that need one, and of no others.
void refuse_faulty_imu(const dataset::Dataset& dataset, const odometry::OdometryRequest& request) {
  if (dataset.imu_fault.empty()) return;
  for (const odometry::AlgorithmInfo& info : odometry::list_algorithms()) {
    if (info.name == request.algorithm && info.needs_imu)
      throw InputError(request.algorithm, "needs the IMU", dataset.imu_fault);
  }
}

/// A run in which no scan was ever tracked has no poses but that of the start.
void judge_start(odometry::RunSummary& summary) {
  constexpr std::size_t kInitializing = 10;  // scans; longer than any method needs
  const auto initializing = summary.statuses.find(odometry::ScanStatus::kInitializing);
  if (summary.diverged || summary.scans <= kInitializing) return;
  if (initializing == summary.statuses.end() || initializing->second != summary.scans) return;
  summary.diverged = true;
  summary.reason =
      "the method never left its initialization, all poses are that of the start; it waits for IMU "
      "samples at the time of the scans, or for rest";
}

/// The rig as a method sees it that gets each sweep in several parts.
Rig with_parts(Rig rig, const std::string& lidar_id, int parts) {
  for (LidarInfo& lidar : rig.lidars)
    if (lidar.id == lidar_id) lidar.rate_hz *= parts;
  return rig;
}

/// Writes the scored returns, placed by the motion of the run.
void write_reprojected(EventSource& returns, const std::string& lidar_id,
                       const Pose& body_from_lidar, const dataset::RunFiles& run,
                       const fs::path& file) {
  dataset::CloudWriter map(file, {.intensity = true, .origins = true});
  if (!run.trajectory.empty())
    evaluation::reproject(returns, lidar_id, body_from_lidar, evaluation::BodyMotion(run),
                          [&](const dataset::Cloud& part) { map.write(part); });
  map.commit();
}

}  // namespace

dataset::RunManifest manifest_of(const odometry::RunSummary& summary, const LidarInfo& lidar,
                                 const fs::path& dataset, const fs::path& out,
                                 const Parallel& parallel) {
  const Machine machine = this_machine();
  dataset::RunManifest manifest;
  if (!dataset.empty())  // relative, so that both can be moved together
    manifest.dataset = fs::proximate(fs::absolute(dataset), fs::absolute(out)).generic_string();
  manifest.sensor = lidar.id;
  manifest.body_from_lidar = lidar.body_from_lidar;
  manifest.threads = parallel.threads();
  manifest.status = summary.diverged ? dataset::RunStatus::kDiverged : dataset::RunStatus::kOk;
  manifest.reason = summary.reason;
  manifest.recording_ended = summary.recording_ended;
  manifest.made_on = {machine.processor, static_cast<int>(machine.cores),
                      std::round(machine.memory_gib), LIDARENA_VERSION};
  dataset::RunCounts& counts = manifest.summary;
  counts = {
      summary.scans,          summary.refused,         summary.dropped, summary.longest_delay_s, {},
      summary.sensor_seconds, summary.compute_seconds, summary.diverged};
  for (const auto& [status, count] : summary.statuses)
    counts.statuses[odometry::to_string(status)] = count;
  return manifest;
}

dataset::RunManifest manifest_of(const odometry::OdometryRequest& request, const Json& config,
                                 const odometry::OdometryTraits& traits,
                                 dataset::RunManifest manifest) {
  manifest.algorithm = request.algorithm;
  manifest.preset = request.preset;
  manifest.config = config;
  manifest.config_file = request.config_file;
  manifest.overrides = request.overrides;
  // maps that a method makes itself are voxel means of keyframe clouds
  manifest.own_map = traits.publishes_scans ? dataset::OwnMap::kReturns : dataset::OwnMap::kMeans;
  return manifest;
}

odometry::RunSummary run_algorithm(const RunRequest& request, const fs::path& out,
                                   const Parallel& parallel, LogSink& log) {
  const odometry::OdometryRequest chosen = odometry::with_default_preset(request.odometry);
  const int parts = request.parts > 0 ? request.parts : odometry::parts_of(chosen);
  if (!request.also.empty()) odometry::check_takes_several_lidars(chosen.algorithm);
  dataset::Dataset dataset = opened(request, parallel);
  dataset::tell_opening(dataset, log);
  refuse_faulty_imu(dataset, chosen);
  dataset::read_whole_part(dataset);
  const std::string lidar_id = chosen_lidar(dataset, dataset::id_of_topic(request.read.sensor));
  odometry::MadeOdometry made =
      odometry::make_odometry(chosen, with_parts(dataset.rig, lidar_id, parts), lidar_id, parallel);
  const LidarInfo lidar = *dataset.rig.find_lidar(lidar_id);
  odometry::RunOptions options;
  options.lidar_id = lidar_id;
  if (const ImuInfo* imu = dataset.rig.imu_beside(*dataset.rig.find_lidar(lidar_id))) {
    options.imu_id = imu->id;
  }
  options.scan_count = dataset.scan_count;
  if (options.scan_count) *options.scan_count *= static_cast<std::size_t>(parts);
  options.paced = request.paced;
  dataset::begin_run(out);
  MapRecord map;
  if (request.maps) map.file = out / "map.ply";
  map.is_kept = request.maps;
  Recorder recorder(*made.odometry, log, map);
  evaluation::ReturnStore returns(out, lidar_id,
                                  evaluation::scored_returns(dataset.scan_count.value_or(0)));
  if (request.maps) dataset.events = returns.keep_from(std::move(dataset.events));
  const std::vector<LidarInfo> others = further_lidars(dataset, request, lidar_id);
  if (!others.empty())
    dataset.events = std::make_unique<MergeLidars>(std::move(dataset.events), lidar, others);
  if (parts > 1)
    dataset.events = std::make_unique<SplitSweeps>(std::move(dataset.events), lidar_id, parts);
  odometry::RunSummary summary =
      odometry::run(*made.odometry, *dataset.events, options, recorder, log);
  dataset::tell_reading(dataset, log);
  summary.recording_ended = dataset.report->ended();
  dataset::RunFiles files = recorder.finish(summary.diverged);
  judge_start(summary);
  const odometry::OdometryTraits traits = made.odometry->traits();
  made.odometry.reset();  // its map need not stay in memory
  if (request.maps)
    write_reprojected(*returns.read(), lidar_id, lidar.body_from_lidar, files,
                      out / "reprojected.ply");
  files.maps_on_disk = true;
  files.manifest = manifest_of(chosen, made.config, traits,
                               manifest_of(summary, lidar, request.dataset, out, parallel));
  files.manifest.paced = request.paced;
  files.manifest.parts = parts;
  for (const LidarInfo& other : others) files.manifest.also.push_back(other.id);
  if (!request.maps) files.manifest.own_map = dataset::OwnMap::kNone;
  dataset::write_run(out, files);
  return summary;
}

}  // namespace lidarena::stages
