// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/study/run_algorithm.hpp"

#include <cmath>

#include "lidarena/base/machine.hpp"
#include "lidarena/dataset/json_file.hpp"
#include "lidarena/evaluation/evaluate_run.hpp"
#include "lidarena/evaluation/map/map_error.hpp"
#include "lidarena/evaluation/map/reproject.hpp"
#include "lidarena/study/simulate_dataset.hpp"
#include "lidarena/world/mesh_io.hpp"

namespace lidarena::study {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kScoredPoints = 400'000;  // enough for a picture 2,000 pixels wide

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

dataset::Cloud reprojected_map(const RunRequest& request, const std::string& lidar_id,
                               const Trajectory& trajectory, const Parallel& parallel) {
  dataset::Dataset again = open_scored_returns(request.dataset, request.read, parallel);
  const LidarInfo* lidar = again.rig.find_lidar(lidar_id);
  return evaluation::reproject(*again.events, lidar_id, lidar->body_from_lidar, trajectory);
}

/// At most kScoredPoints of the re-projected map, in the mesh's frame, each with its distance.
dataset::Cloud scored_cloud(const dataset::RunFiles& run, const Pose& mesh_from_map,
                            const world::World& world, const Parallel& parallel) {
  const std::vector<Eigen::Vector3f>& all = run.reprojected.points;
  const std::size_t stride =
      std::max<std::size_t>(1, (all.size() + kScoredPoints - 1) / kScoredPoints);
  dataset::Cloud cloud;
  for (std::size_t i = 0; i < all.size(); i += stride) cloud.points.push_back(all[i]);
  evaluation::map_error(cloud.points, mesh_from_map, world, parallel, &cloud.distance);
  cloud.points = transformed(mesh_from_map, cloud.points);
  return cloud;
}

/// The truth of scans that are in memory.
class ScansInMemory : public dataset::ScanTruthSource {
 public:
  explicit ScansInMemory(const std::vector<dataset::ScanTruth>& scans) : scans_(scans) {}
  std::optional<dataset::ScanTruth> next() override {
    if (next_ == scans_.size()) return std::nullopt;
    return scans_[next_++];
  }

 private:
  const std::vector<dataset::ScanTruth>& scans_;
  std::size_t next_ = 0;
};

/// What the rays of the run's LiDAR hit; empty, with a warning, if the dataset cannot be read
/// again.
std::optional<evaluation::RayTruth> ray_truth(const fs::path& path, const std::string& lidar_id,
                                              const Trajectory& estimate, const Trajectory& truth,
                                              const world::World& world, const Parallel& parallel,
                                              LogSink& log) {
  try {
    dataset::ReadOptions read;
    read.sensor = lidar_id;
    ScoredHits hits;
    dataset::Dataset again = open_scored_returns(path, read, parallel, &hits);
    const LidarInfo* lidar = again.rig.find_lidar(lidar_id);
    if (lidar == nullptr) throw InputError(path.string(), "has no LiDAR named " + lidar_id);
    if (!hits.known) {
      return evaluation::RayTruth{
          evaluation::observe(*again.events, lidar->id, lidar->body_from_lidar, truth, world,
                              parallel),
          {}};
    }
    // The re-projected map once more, for the return that each of its points comes from.
    std::vector<evaluation::ReturnOrigin> origins;
    const dataset::Cloud map = evaluation::reproject(
        *again.events, lidar->id, lidar->body_from_lidar, estimate, 0.02, nullptr, &origins);
    ScansInMemory observed(hits.scans), identified(hits.scans);
    return evaluation::RayTruth{evaluation::observe(observed, world, parallel),
                                evaluation::identify(map.points, origins, identified)};
  } catch (const InputError& error) {
    log.warn(std::string("completeness and signed distance are left out: ") + error.what());
    return std::nullopt;
  }
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
  odometry::RunResult result = odometry::run(*made.odometry, *dataset.events, options, log);
  if (!result.files.trajectory.empty()) {
    result.files.reprojected =
        reprojected_map(request, lidar_id, result.files.trajectory, parallel);
  }
  result.files.manifest = {{"kind", "run"},
                           {"algorithm", chosen.algorithm},
                           {"preset", chosen.preset},
                           {"config", made.config},
                           {"dataset", relative_path(request.dataset, out)},
                           {"sensor", lidar_id},
                           {"threads", parallel.threads()},
                           {"paced", request.paced},
                           {"status", result.summary.diverged ? "diverged" : "ok"},
                           {"reason", result.summary.reason},
                           {"made_on", made_on()},
                           {"summary", summary_json(result.summary)}};
  dataset::write_run(out, result.files);
  return result.summary;
}

results::RunMetrics score_run(const fs::path& folder, const Parallel& parallel, LogSink& log) {
  const dataset::RunFiles run = dataset::read_run(folder);
  const fs::path dataset = folder / run.manifest.at("dataset").get<std::string>();
  const auto truth = dataset::load_truth(dataset);
  if (!truth) {
    throw InputError(dataset.string(), "contains no truth to score against",
                     "give one: evaluate --trajectory FILE --truth FILE");
  }
  std::unique_ptr<world::World> world;
  if (const auto mesh = dataset::find_world_mesh(dataset)) {
    world = std::make_unique<world::World>(world::load_mesh(*mesh), mesh->string());
  }
  const auto observe = [&] {
    return ray_truth(dataset, run.manifest.value("sensor", ""), run.trajectory, *truth, *world,
                     parallel, log);
  };
  const results::RunMetrics metrics =
      evaluation::evaluate_run(run, *truth, world.get(), parallel, log, observe);
  const std::optional<Pose> mesh_from_map = results::truth_from_estimate(metrics);
  if (world && mesh_from_map && !run.reprojected.points.empty()) {
    dataset::write_ply(folder / "scored.ply", scored_cloud(run, *mesh_from_map, *world, parallel));
  }
  results::write_metrics(folder, metrics);
  return metrics;
}

void remove_maps(const fs::path& run) {
  for (const char* map : {"map.ply", "reprojected.ply", "scored.ply"}) fs::remove(run / map);
}

}  // namespace lidarena::study
