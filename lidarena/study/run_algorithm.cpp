// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/study/run_algorithm.hpp"

#include <cmath>

#include "lidarena/base/machine.hpp"
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
  for (const std::string& note : dataset.notes) log.info("note: " + note);
  const std::string lidar_id = chosen_lidar(dataset, request.read.sensor);
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
  if (!chosen.config_file.empty()) result.files.manifest["config_file"] = chosen.config_file;
  if (!chosen.overrides.empty()) result.files.manifest["overrides"] = chosen.overrides;
  dataset::write_run(out, result.files);
  return result.summary;
}

}  // namespace lidarena::study
