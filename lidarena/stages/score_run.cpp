// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/stages/score_run.hpp"

#include <algorithm>

#include "lidarena/dataset/dataset.hpp"
#include "lidarena/dataset/dataset_manifest.hpp"
#include "lidarena/dataset/hits_file.hpp"
#include "lidarena/evaluation/diagnosis/lever_arm.hpp"
#include "lidarena/evaluation/evaluate_run.hpp"
#include "lidarena/evaluation/map/map_error.hpp"
#include "lidarena/evaluation/map/observed_surface.hpp"
#include "lidarena/map/point_map.hpp"
#include "lidarena/sensor/sensor_clock.hpp"
#include "lidarena/sensor/simulate.hpp"
#include "lidarena/world/mesh_io.hpp"

namespace lidarena::stages {
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

/// The truth with the times that the clock of the simulated LiDAR `sensor` showed; empty if that
/// clock had neither offset nor drift, or the dataset was recorded.
std::optional<Trajectory> truth_at_clock(const fs::path& dataset, const std::string& sensor,
                                         const Trajectory& truth) {
  const auto manifest = dataset::read_dataset_manifest(dataset);
  if (!manifest || !manifest->simulation || !manifest->simulation->noise) return std::nullopt;
  std::vector<sensor::SensorConfig> sensors;
  read_value(ConfigNode::parse(Json(manifest->simulation->sensors).dump(),
                               (dataset / "manifest.json").string()),
             sensors, {});
  const std::vector<LidarInfo> lidars = sensor::make_rig(sensors).lidars;
  const auto found = std::ranges::find(lidars, sensor, &LidarInfo::id);
  if (found == lidars.end()) return std::nullopt;
  const sensor::ClockConfig& errors = sensors[found - lidars.begin()].noise.clock;
  if (errors.offset_s == 0.0 && errors.drift == 0.0) return std::nullopt;
  const sensor::SensorClock clock(errors.offset_s, errors.drift, 0.0, Time{0}, sensor, 0);
  std::vector<StampedPose> poses(truth.poses().begin(), truth.poses().end());
  for (StampedPose& pose : poses) pose.stamp = clock.reading(pose.stamp);
  return Trajectory(std::move(poses), "truth by the LiDAR's clock");
}

/// The map of a perfect estimate that is known only at the instants of `estimate`.
std::vector<Eigen::Vector3f> interpolated_map(std::span<const evaluation::TimedReturn> returns,
                                              const Pose& body_from_lidar,
                                              const Trajectory& estimate, const Trajectory& truth) {
  const Trajectory perfect = evaluation::truth_at_estimates(estimate, truth);
  evaluation::LidarPoses poses(perfect, body_from_lidar);
  map::PointMap map(0.02);
  for (const evaluation::TimedReturn& measured : returns) {
    if (const Pose* world_from_lidar = poses.at(measured.stamp))
      map.insert((*world_from_lidar * measured.position).cast<float>());
  }
  return map.take();
}

/// What the rays of the flight hit: by the hits that the simulator has written beside the
/// measurements, else by casting the rays of the map's points again.
evaluation::RayTruth ray_truth(const fs::path& dataset, const dataset::RunFiles& run,
                               const Trajectory& truth, const world::World& world,
                               const Parallel& parallel) {
  const std::string& sensor = run.manifest.sensor;
  const auto hits = dataset::open_hits(dataset, sensor);
  evaluation::RayTruth rays;
  if (hits) {
    rays.observed = evaluation::observe(*hits, world, parallel);
    rays.identified = evaluation::identify(run.reprojected, *dataset::open_hits(dataset, sensor),
                                           world.mesh().triangles.size());
  }
  if (hits && !run.motion.empty()) return rays;
  if (run.reprojected.origins.empty() || !run.manifest.body_from_lidar)
    throw InputError("reprojected.ply", "has no origins of its points", "run the algorithm again");
  const Pose& body_from_lidar = *run.manifest.body_from_lidar;
  const std::vector<evaluation::TimedReturn> returns =
      evaluation::returns_of(run.reprojected, evaluation::BodyMotion(run), body_from_lidar);
  if (!hits) rays.observed = evaluation::observe(returns, body_from_lidar, truth, world, parallel);
  if (run.motion.empty())
    rays.interpolated = interpolated_map(returns, body_from_lidar, run.trajectory, truth);
  return rays;
}

/// Writes results; where the folder can only be read, that is said and the figures are still given.
template <class Write>
void store(const Write& write, LogSink& log) {
  try {
    write();
  } catch (const Error& error) {
    log.warn(std::string("the figures are not stored: ") + error.what());
  }
}

bool has(const ScoreParts& parts, ScorePart part) {
  return std::ranges::find(parts, part) != parts.end();
}

}  // namespace

bool scores_maps(const ScoreParts& parts) {
  return parts.empty() || has(parts, ScorePart::kMap) || has(parts, ScorePart::kVertices);
}

results::RunMetrics score_run(const fs::path& folder, const ScoreParts& parts,
                              const Parallel& parallel, LogSink& log, const GivenTruth* given) {
  const bool with_maps = scores_maps(parts);
  dataset::RunFiles run =
      dataset::read_run(folder, with_maps ? dataset::ReadMaps::kYes : dataset::ReadMaps::kNo);
  const fs::path dataset = folder / run.manifest.dataset;
  if (given != nullptr && given->truth_from_body) {
    run.trajectory = evaluation::moved_to_body(run.trajectory, *given->truth_from_body);
    run.live = evaluation::moved_to_body(run.live, *given->truth_from_body);
  }
  const auto truth =
      given != nullptr ? std::optional(given->poses.trajectory) : dataset::load_truth(dataset);
  if (!truth) {
    throw InputError(dataset.string(), "contains no truth to score against",
                     "give one: evaluate RUN --truth FILE");
  }
  std::unique_ptr<world::World> world;
  if (const auto mesh = dataset::find_world_mesh(dataset); with_maps && mesh) {
    world = std::make_unique<world::World>(world::load_mesh(*mesh), mesh->string());
  }
  const auto observe = [&]() -> std::optional<evaluation::RayTruth> {
    try {
      return ray_truth(dataset, run, *truth, *world, parallel);
    } catch (const InputError& error) {
      log.warn(std::string("completeness and signed distance are left out: ") + error.what());
      return std::nullopt;
    }
  };
  std::optional<Trajectory> at_clock;
  if (given == nullptr) at_clock = truth_at_clock(dataset, run.manifest.sensor, *truth);
  evaluation::ScoredPoints scored;
  results::RunMetrics metrics = evaluation::evaluate_run(
      run, *truth, world.get(), parallel, log,
      {.observe = observe, .scored = &scored, .vertices = has(parts, ScorePart::kVertices)},
      at_clock ? &*at_clock : nullptr);
  if (given != nullptr) metrics.frames = {given->poses.body, given->lever};
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

}  // namespace lidarena::stages
