// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/report/scene_files.hpp"
#include "lidarena/results/run_metrics.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "lidarena/base/random.hpp"
#include "lidarena/dataset/points/point_table.hpp"
#include "lidarena/dataset/run_manifest.hpp"
#include "lidarena/dataset/trajectories/trajectory_io.hpp"
#include "lidarena/dataset/trajectories/tum.hpp"
#include "lidarena/world/mesh_io.hpp"
#include "lidarena/world/world.hpp"

namespace lidarena::report {
namespace {

namespace fs = std::filesystem;

constexpr double kMinOriginDistance_m =
    1000.0;                                 // beyond this, coordinates are relative to an origin
constexpr double kOriginStep_m = 100.0;     // the origin is rounded to multiples of this
constexpr double kMaxMeshDistance_m = 2.0;  // maximum distance to the mesh that is measured
constexpr double kMinEpochTime_s = 1e6;     // larger times are times since an epoch
constexpr float kNoValue = std::numeric_limits<float>::quiet_NaN();

bool is_empty(const Scene& scene) {
  return scene.clouds.empty() && scene.paths.empty() && scene.meshes.empty();
}

/// The first object of a scene determines the scene's origin.
void choose_origin(Scene& scene, const Eigen::Vector3d& somewhere) {
  if (!is_empty(scene) || !(somewhere.norm() > kMinOriginDistance_m)) return;
  scene.origin = (somewhere / kOriginStep_m).array().round().matrix() * kOriginStep_m;
}

void choose_time_origin(Scene& scene, Time first) {
  if (scene.time_origin == Time{0}) scene.time_origin = first;
}

/// Keeps a random sample of a stream of unknown length: all points at first, half as many each time
/// the limit is exceeded. Whether a point is kept depends only on its index.
class Thinning {
 public:
  explicit Thinning(std::size_t limit) : limit_(limit) {}

  /// Whether to keep the next point.
  bool keeps_next() {
    const double draw = random_.uniform(seen_++);
    if (draw >= share_) return false;
    draws_.push_back(draw);
    return true;
  }
  /// To be called after a point was kept: drops points of `cloud` if there are too many.
  void enforce_limit(SceneCloud& cloud) {
    while (draws_.size() > limit_) {
      share_ /= 2;
      drop(cloud.points);
      drop(cloud.intensity);
      drop(cloud.time);
      std::erase_if(draws_, [&](double draw) { return draw >= share_; });
    }
  }
  std::size_t left_out() const { return seen_ - draws_.size(); }

 private:
  template <class T>
  void drop(std::vector<T>& values) const {
    if (values.size() != draws_.size()) return;
    std::size_t kept = 0;
    for (std::size_t i = 0; i < values.size(); ++i) {
      if (draws_[i] < share_) values[kept++] = values[i];
    }
    values.resize(kept);
  }

  CounterRandom random_{0, stream_of("thinning")};
  std::size_t limit_;
  std::size_t seen_ = 0;
  double share_ = 1.0;
  std::vector<double> draws_;
};

/// At most about `max_poses` poses of a trajectory, including the first and the last.
Trajectory thinned(const Trajectory& trajectory, std::size_t max_poses) {
  const std::size_t stride = trajectory.size() / max_poses + 1;
  if (stride == 1) return trajectory;
  std::vector<StampedPose> poses;
  for (std::size_t i = 0; i + 1 < trajectory.size(); i += stride) {
    poses.push_back(trajectory.poses()[i]);
  }
  poses.push_back(trajectory.poses().back());
  return Trajectory(std::move(poses));
}

void add_path(Scene& scene, const std::string& name, PathRole role, const Trajectory& trajectory,
              const SceneOptions& options) {
  if (trajectory.empty()) return;
  choose_origin(scene, trajectory.poses().front().world_from_body.translation());
  choose_time_origin(scene, trajectory.begin_time());
  scene.paths.push_back({name, role, thinned(trajectory, options.max_poses), {}});
}

bool has_mesh(const Scene& scene, const std::string& name) {
  return std::any_of(scene.meshes.begin(), scene.meshes.end(),
                     [&](const SceneMesh& mesh) { return mesh.name == name; });
}

bool has_path(const Scene& scene, const std::string& name) {
  return std::any_of(scene.paths.begin(), scene.paths.end(),
                     [&](const ScenePath& path) { return path.name == name; });
}

/// Adds mesh and true path of a dataset, only once if several runs share it. Returns the truth.
std::optional<Trajectory> add_truth(Scene& scene, const fs::path& dataset,
                                    const SceneOptions& options, LogSink& log) {
  const std::string name = dataset.lexically_normal().filename().string();
  const auto truth = dataset::load_truth(dataset);
  if (truth && !has_path(scene, "truth of " + name)) {
    add_path(scene, "truth of " + name, PathRole::kTruth, *truth, options);
  }
  const auto mesh = dataset::find_world_mesh(dataset);
  if (mesh && !has_mesh(scene, "mesh of " + name)) {
    try {
      scene.meshes.push_back({"mesh of " + name, world::load_mesh(*mesh)});
    } catch (const InputError& error) {
      log.warn(std::string("the mesh is left out: ") + error.what());
    }
  }
  return truth;
}

/// Distance to the truth at each pose; NaN where the truth has no pose.
std::vector<double> errors_against(const Trajectory& estimate, const Trajectory& truth) {
  std::vector<double> errors;
  for (const StampedPose& pose : estimate.poses()) {
    const auto there = truth.at(pose.stamp);
    errors.push_back(there ? (pose.world_from_body.translation() - there->translation()).norm()
                           : NAN);
  }
  return errors;
}

Trajectory moved(const Trajectory& trajectory, const Pose& by) {
  std::vector<StampedPose> poses(trajectory.poses().begin(), trajectory.poses().end());
  for (StampedPose& pose : poses) pose.world_from_body = by * pose.world_from_body;
  return Trajectory(std::move(poses));
}

SceneCloud cloud_of(Scene& scene, const dataset::PointTable& table, const Pose& scene_from_cloud,
                    std::size_t limit) {
  const dataset::Column& x = table.require("x");
  const dataset::Column& y = table.require("y");
  const dataset::Column& z = table.require("z");
  const dataset::Column* distance = table.find({"distance", "scalar_distance"});
  const dataset::Column* intensity = table.find({"intensity", "scalar_intensity", "reflectivity"});
  const dataset::Column* time = table.find({"time", "scalar_time", "timestamp", "gps_time"});
  const auto at = [&](std::size_t i) -> Eigen::Vector3d {
    return scene_from_cloud *
           Eigen::Vector3d(table.number(x, i), table.number(y, i), table.number(z, i));
  };
  if (table.size > 0) choose_origin(scene, at(0));
  const double first_time = time != nullptr && table.size > 0 ? table.number(*time, 0) : 0.0;
  const double time_zero = std::abs(first_time) > kMinEpochTime_s ? first_time : 0.0;

  SceneCloud cloud;
  const CounterRandom random(0, stream_of("thinning"));
  const double share = static_cast<double>(limit) / static_cast<double>(table.size);
  for (std::size_t i = 0; i < table.size; ++i) {
    if (share < 1.0 && random.uniform(i) >= share) continue;
    cloud.points.push_back((at(i) - scene.origin).cast<float>());
    const auto add = [&](std::vector<float>& values, const dataset::Column* from, double zero) {
      if (from != nullptr) values.push_back(static_cast<float>(table.number(*from, i) - zero));
    };
    add(cloud.distance, distance, 0.0);
    add(cloud.intensity, intensity, 0.0);
    add(cloud.time, time, time_zero);
  }
  cloud.left_out = table.size - cloud.points.size();
  return cloud;
}

/// Collects the points of scans in the world frame, each by the true pose at its own instant;
/// points without a true pose become NaN. Without a truth, points stay in the sensor's frame.
class ScanCollector {
 public:
  ScanCollector(const Scene& scene, const Pose& body_from_lidar, const Trajectory* truth,
                std::size_t limit)
      : scene_(scene), body_from_lidar_(body_from_lidar), truth_(truth), thinning_(limit) {}

  void take(const Scan& scan) {
    for (const Point& point : scan.points) {
      if (!thinning_.keeps_next()) continue;
      const Time t = scan.stamp + Time{point.dt_ns};
      cloud_.points.push_back(place(point.position.cast<double>(), t));
      cloud_.intensity.push_back(point.intensity);
      cloud_.time.push_back(static_cast<float>(to_seconds(t - scene_.time_origin)));
      thinning_.enforce_limit(cloud_);
    }
  }
  SceneCloud finished(std::string name) {
    cloud_.name = std::move(name);
    cloud_.left_out = thinning_.left_out();
    return std::move(cloud_);
  }

 private:
  Eigen::Vector3f place(const Eigen::Vector3d& in_lidar, Time t) const {
    if (truth_ == nullptr) return in_lidar.cast<float>();
    const auto world_from_body = truth_->at(t);
    if (!world_from_body) return Eigen::Vector3f::Constant(kNoValue);
    return (*world_from_body * (body_from_lidar_ * in_lidar) - scene_.origin).cast<float>();
  }

  const Scene& scene_;
  Pose body_from_lidar_;
  const Trajectory* truth_;
  Thinning thinning_;
  SceneCloud cloud_;
};

std::string run_label(const fs::path& folder, const dataset::RunManifest& manifest) {
  return (manifest.algorithm.empty() ? folder.filename().string() : manifest.algorithm) +
         (manifest.preset.empty() ? "" : " (" + manifest.preset + ")") +
         (manifest.sensor.empty() ? "" : ", " + manifest.sensor);
}

}  // namespace

void add_cloud_file(Scene& scene, const fs::path& file, const SceneOptions& options) {
  SceneCloud cloud =
      cloud_of(scene, dataset::read_point_table(file), Pose::Identity(), options.max_points);
  cloud.name = file.filename().string();
  scene.clouds.push_back(std::move(cloud));
}

void add_path_file(Scene& scene, const fs::path& file) {
  add_path(scene, file.filename().string(), PathRole::kEstimate, dataset::read_trajectory(file),
           {});
}

void add_dataset(Scene& scene, dataset::Dataset dataset, const SceneOptions& options,
                 LogSink& log) {
  const auto truth = add_truth(scene, dataset.path, options, log);
  std::map<std::string, ScanCollector> collectors;
  Time longest_scan{0};
  while (const auto event = dataset.events->next()) {
    const auto* scan = std::get_if<Scan>(&event->data);
    const LidarInfo* lidar = dataset.rig.find_lidar(event->sensor_id);
    if (scan == nullptr || lidar == nullptr) continue;
    if (collectors.empty()) choose_time_origin(scene, scan->stamp);
    collectors
        .try_emplace(event->sensor_id, scene, lidar->body_from_lidar, truth ? &*truth : nullptr,
                     options.max_points)
        .first->second.take(*scan);
    for (const Point& p : scan->points) longest_scan = std::max(longest_scan, Time{p.dt_ns});
  }
  for (auto& [id, collector] : collectors) scene.clouds.push_back(collector.finished(id));
  if (truth || collectors.empty()) return;
  scene.frame = "sensor";
  scene.window_s = std::max(0.1, to_seconds(longest_scan));
  log.info("no truth: points are shown in the sensor's frame, one scan at a time");
}

void add_run(Scene& scene, const fs::path& folder, const SceneOptions& options, LogSink& log) {
  const dataset::RunManifest manifest = dataset::read_run_manifest(folder);
  const std::string label = run_label(folder, manifest);
  const auto truth = add_truth(scene, folder / manifest.dataset, options, log);
  const auto scored = fs::exists(folder / "metrics.json")
                          ? results::truth_from_estimate(results::read_metrics(folder))
                          : std::nullopt;
  if (truth && !scored) log.warn(label + ": not scored, so the map is not aligned with the mesh");
  const Pose scene_from_map = scored.value_or(Pose::Identity());

  const Trajectory estimate =
      moved(dataset::read_tum(folder / "trajectory.tum", dataset::EmptyTrajectory::kAllowed),
            scene_from_map);
  add_path(scene, label, PathRole::kEstimate, estimate, options);
  if (truth && !estimate.empty()) {
    scene.paths.back().error_m = errors_against(scene.paths.back().trajectory, *truth);
  }
  const auto add_map = [&](const char* file, const std::string& what, const Pose& placed) {
    SceneCloud cloud =
        cloud_of(scene, dataset::read_point_table(folder / file), placed, options.max_points);
    cloud.name = label + what;
    cloud.visible = scene.clouds.empty();
    scene.clouds.push_back(std::move(cloud));
  };
  const MapChoice map = options.map;
  if (map == MapChoice::kScored && fs::exists(folder / "scored.ply")) {
    add_map("scored.ply", "", Pose::Identity());  // it is in the mesh's frame already
  }
  if (map == MapChoice::kReprojected || map == MapChoice::kBoth) {
    add_map("reprojected.ply", "", scene_from_map);
  }
  if (map == MapChoice::kOwn || map == MapChoice::kBoth) {
    add_map("map.ply", ", own map", scene_from_map);
  }
}

void measure_distances(Scene& scene, const Parallel& parallel) {
  const bool needed = std::any_of(scene.clouds.begin(), scene.clouds.end(),
                                  [](const SceneCloud& c) { return c.distance.empty(); });
  world::TriangleMesh all;
  for (const SceneMesh& mesh : scene.meshes) all.append(mesh.mesh);
  if (!needed || all.empty() || scene.frame == "sensor") return;
  const world::World world(std::move(all));
  for (SceneCloud& cloud : scene.clouds) {
    if (!cloud.distance.empty()) continue;
    cloud.distance.resize(cloud.points.size());
    constexpr std::size_t kBlock = 65'536;
    parallel.for_blocks(cloud.points.size(), kBlock, [&](std::size_t begin, std::size_t end) {
      std::vector<Eigen::Vector3d> points;
      for (std::size_t i = begin; i < end; ++i) {
        points.push_back(cloud.points[i].cast<double>() + scene.origin);
      }
      std::vector<world::ClosestPoint> nearest(points.size());
      world.closest_points(points, kMaxMeshDistance_m, nearest, Parallel(1));
      for (std::size_t i = begin; i < end; ++i) {
        const world::ClosestPoint& there = nearest[i - begin];
        cloud.distance[i] = there.valid() ? static_cast<float>(there.distance) : kNoValue;
      }
    });
  }
}

}  // namespace lidarena::report
