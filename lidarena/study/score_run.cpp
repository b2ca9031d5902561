// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/study/score_run.hpp"

#include <unistd.h>

#include "lidarena/evaluation/evaluate_run.hpp"
#include "lidarena/evaluation/map/map_error.hpp"
#include "lidarena/evaluation/map/reproject.hpp"
#include "lidarena/evaluation/map/return_store.hpp"
#include "lidarena/evaluation/map/scored_returns.hpp"
#include "lidarena/study/simulate_dataset.hpp"
#include "lidarena/world/mesh_io.hpp"

namespace lidarena::study {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kScoredPoints = 400'000;  // enough for a picture 2,000 pixels wide

/// At most kScoredPoints of the re-projected map, in the mesh's frame, each with its distance:
/// those of `scored` where it has them all.
dataset::Cloud scored_cloud(const dataset::RunFiles& run, const Pose& mesh_from_map,
                            const evaluation::ScoredPoints& scored, const world::World& world,
                            const Parallel& parallel) {
  const std::vector<Eigen::Vector3f>& all = run.reprojected.points;
  const std::size_t stride =
      std::max<std::size_t>(1, (all.size() + kScoredPoints - 1) / kScoredPoints);
  dataset::Cloud cloud;
  for (std::size_t i = 0; i < all.size(); i += stride) cloud.points.push_back(all[i]);
  if (scored.stride > 0 && stride % scored.stride == 0 &&
      scored.mesh_from_map.matrix() == mesh_from_map.matrix()) {
    for (std::size_t i = 0; i < all.size(); i += stride)
      cloud.distance.push_back(scored.distances[i / scored.stride]);
  } else {
    evaluation::map_error(cloud.points, mesh_from_map, world, parallel, &cloud.distance);
  }
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

/// The folder, or the one for temporary files where it can only be read.
fs::path writable(const fs::path& folder) {
  return access(folder.c_str(), W_OK) == 0 ? folder : fs::temp_directory_path();
}

/// The returns of a run's LiDAR, read from its dataset once.
class ReturnsOfRun {
 public:
  /// Throws InputError if the dataset cannot be read again.
  ReturnsOfRun(const fs::path& folder, const fs::path& dataset, const dataset::RunFiles& run,
               const Parallel& parallel)
      : lidar_id_(run.manifest.value("sensor", "")),
        store_(writable(folder), lidar_id_, evaluation::kScoredReturns) {
    dataset::ReadOptions read;
    read.sensor = lidar_id_;
    dataset::Dataset source = open_scored_returns(dataset, read, parallel, &hits_);
    const LidarInfo* lidar = source.rig.find_lidar(lidar_id_);
    if (lidar == nullptr) throw InputError(dataset.string(), "has no LiDAR named " + lidar_id_);
    body_from_lidar_ = lidar->body_from_lidar;
    // The re-projected map once more, for the return that each of its points comes from.
    map_ = placed(*store_.keep_from(*source.events), evaluation::BodyMotion(run), &origins_);
  }

  evaluation::RayTruth truth(const dataset::RunFiles& run, const Trajectory& truth,
                             const world::World& world, const Parallel& parallel) const {
    evaluation::RayTruth rays;
    if (hits_.known) {
      ScansInMemory observed(hits_.scans), identified(hits_.scans);
      rays.observed = evaluation::observe(observed, world, parallel);
      rays.identified = evaluation::identify(map_, origins_, identified);
    } else {
      rays.observed =
          evaluation::observe(*store_.read(), lidar_id_, body_from_lidar_, truth, world, parallel);
    }
    if (run.motion.empty()) {
      const Trajectory perfect = evaluation::truth_at_estimates(run.trajectory, truth);
      rays.interpolated = placed(*store_.read(), perfect, nullptr);
    }
    return rays;
  }

 private:
  std::vector<Eigen::Vector3f> placed(dataset::EventSource& events,
                                      const evaluation::BodyMotion& motion,
                                      std::vector<evaluation::ReturnOrigin>* origins) const {
    return evaluation::reproject(events, lidar_id_, body_from_lidar_, motion, 0.02, nullptr,
                                 origins)
        .points;
  }

  std::string lidar_id_;
  evaluation::ReturnStore store_;
  ScoredHits hits_;
  Pose body_from_lidar_ = Pose::Identity();
  std::vector<Eigen::Vector3f> map_;
  std::vector<evaluation::ReturnOrigin> origins_;
};

/// Writes results; where the folder can only be read, that is said and the figures are still given.
template <class Write>
void store(const Write& write, LogSink& log) {
  try {
    write();
  } catch (const Error& error) {
    log.warn(std::string("the figures are not stored: ") + error.what());
  }
}

}  // namespace

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
  const auto observe = [&]() -> std::optional<evaluation::RayTruth> {
    try {
      return ReturnsOfRun(folder, dataset, run, parallel).truth(run, *truth, *world, parallel);
    } catch (const InputError& error) {
      log.warn(std::string("completeness and signed distance are left out: ") + error.what());
      return std::nullopt;
    }
  };
  evaluation::ScoredPoints scored;
  const results::RunMetrics metrics =
      evaluation::evaluate_run(run, *truth, world.get(), parallel, log, observe, &scored);
  const std::optional<Pose> mesh_from_map = results::truth_from_estimate(metrics);
  if (world && mesh_from_map && !run.reprojected.points.empty()) {
    const dataset::Cloud cloud = scored_cloud(run, *mesh_from_map, scored, *world, parallel);
    store([&] { dataset::write_ply(folder / "scored.ply", cloud); }, log);
  }
  store([&] { results::write_metrics(folder, metrics); }, log);
  return metrics;
}

void remove_maps(const fs::path& run) {
  for (const char* map : {"motion.tum", "map.ply", "reprojected.ply", "scored.ply"})
    fs::remove(run / map);
}

}  // namespace lidarena::study
