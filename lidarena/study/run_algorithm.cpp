// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/study/run_algorithm.hpp"

#include <cmath>

#include "lidarena/base/machine.hpp"
#include "lidarena/dataset/single_lidar.hpp"
#include "lidarena/dataset/whole_part.hpp"
#include "lidarena/evaluation/map/reproject.hpp"
#include "lidarena/evaluation/map/return_store.hpp"
#include "lidarena/evaluation/map/scored_returns.hpp"
#include "lidarena/study/simulate_dataset.hpp"

namespace lidarena::study {
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

/// Path of `dataset` relative to `run`, so that both can be moved together.
std::string relative_path(const fs::path& dataset, const fs::path& run) {
  const fs::path relative = fs::proximate(fs::absolute(dataset), fs::absolute(run));
  return relative.generic_string();
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

}  // namespace

Json summary_json(const odometry::RunSummary& summary) {
  Json statuses = Json::object();
  for (const auto& [status, count] : summary.statuses)
    statuses[odometry::to_string(status)] = count;
  return {{"scans", summary.scans},
          {"dropped", summary.dropped},
          {"longest_delay_s", summary.longest_delay_s},
          {"statuses", statuses},
          {"sensor_seconds", summary.sensor_seconds},
          {"compute_seconds", summary.compute_seconds},
          {"diverged", summary.diverged}};
}

Json made_on() {
  const Machine machine = this_machine();
  return {{"processor", machine.processor},
          {"cores", machine.cores},
          {"memory_gib", std::round(machine.memory_gib)},
          {"lidarena", LIDARENA_VERSION}};
}

odometry::RunSummary run_algorithm(const RunRequest& request, const fs::path& out,
                                   const Parallel& parallel, LogSink& log) {
  const odometry::OdometryRequest chosen = odometry::with_default_preset(request.odometry);
  dataset::Dataset dataset = open_any_dataset(request.dataset, request.read, parallel);
  dataset::tell_opening(dataset, log);
  refuse_faulty_imu(dataset, chosen);
  dataset::read_whole_part(dataset);
  const std::string lidar_id = chosen_lidar(dataset, dataset::id_of_topic(request.read.sensor));
  const odometry::MadeOdometry made =
      odometry::make_odometry(chosen, dataset.rig, lidar_id, parallel);
  odometry::RunOptions options;
  options.lidar_id = lidar_id;
  if (const ImuInfo* imu = dataset.rig.imu_beside(*dataset.rig.find_lidar(lidar_id))) {
    options.imu_id = imu->id;
  }
  options.scan_count = dataset.scan_count;
  options.paced = request.paced;
  evaluation::ReturnStore returns(out, lidar_id,
                                  evaluation::scored_returns(dataset.scan_count.value_or(0)));
  odometry::RunResult result =
      odometry::run(*made.odometry, *returns.keep_from(*dataset.events), options, log);
  dataset::tell_reading(dataset, log);
  result.summary.recording_ended = dataset.report->ended();
  judge_start(result.summary);
  if (!result.files.trajectory.empty()) {
    result.files.reprojected = evaluation::reproject(
        *returns.read(), lidar_id, dataset.rig.find_lidar(lidar_id)->body_from_lidar,
        evaluation::BodyMotion(result.files));
  }
  result.files.manifest = {
      {"kind", "run"},
      {"algorithm", chosen.algorithm},
      {"preset", chosen.preset},
      {"config", made.config},
      {"dataset", relative_path(request.dataset, out)},
      {"sensor", lidar_id},
      {"threads", parallel.threads()},
      {"paced", request.paced},
      // maps that a method makes itself are voxel means of keyframe clouds
      {"own_map", made.odometry->traits().publishes_scans ? "returns" : "means"},
      {"status", result.summary.diverged ? "diverged" : "ok"},
      {"reason", result.summary.reason},
      {"made_on", made_on()},
      {"summary", summary_json(result.summary)}};
  if (!result.summary.recording_ended.empty())
    result.files.manifest["recording_ended"] = result.summary.recording_ended;
  if (!chosen.config_file.empty()) result.files.manifest["config_file"] = chosen.config_file;
  if (!chosen.overrides.empty()) result.files.manifest["overrides"] = chosen.overrides;
  dataset::write_run(out, result.files);
  return result.summary;
}

}  // namespace lidarena::study
