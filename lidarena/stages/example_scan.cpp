// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/stages/example_scan.hpp"

#include <variant>

#include "lidarena/base/so3.hpp"
#include "lidarena/dataset/points/cloud.hpp"
#include "lidarena/evaluation/map/lidar_poses.hpp"
#include "lidarena/evaluation/map/map_error.hpp"
#include "lidarena/evaluation/map/scored_returns.hpp"
#include "lidarena/stages/simulate_dataset.hpp"
#include "lidarena/world/mesh_io.hpp"

namespace lidarena::stages {
namespace {

namespace fs = std::filesystem;

constexpr Time kSearchDuration = std::chrono::minutes(1);  // only the first minute is searched

/// Rotation of the body during the scan, rad.
double rotation_during(const Scan& scan, const Trajectory& truth) {
  const auto begin = truth.at(scan.stamp), end = truth.at(end_of(scan));
  if (!begin || !end) return 0.0;
  return so3::angle(begin->linear().transpose() * end->linear());
}

Scan scan_with_most_rotation(EventSource& events, const std::string& lidar_id,
                             const Trajectory& truth) {
  Scan fastest;
  double max_rotation = -1.0;
  while (const std::optional<Event> event = events.next()) {
    const Scan* scan = std::get_if<Scan>(&event->data);
    if (scan == nullptr || event->sensor_id != lidar_id) continue;
    if (scan->stamp - truth.begin_time() > kSearchDuration) break;
    if (const double rotation = rotation_during(*scan, truth); rotation > max_rotation) {
      max_rotation = rotation;
      fastest = *scan;
    }
  }
  return fastest;
}

/// The scan in the world frame: each point by the pose at its own instant, or all points by the
/// pose at the scan's stamp if `skewed`.
dataset::Cloud scan_in_world(const Scan& scan, evaluation::LidarPoses poses, bool skewed) {
  dataset::Cloud cloud;
  for (const Point& point : scan.points) {
    const Pose* world_from_lidar = poses.at(skewed ? scan.stamp : time_of(scan, point));
    if (world_from_lidar == nullptr || !point.position.allFinite()) continue;
    cloud.points.push_back((*world_from_lidar * point.position.cast<double>()).cast<float>());
  }
  return cloud;
}

}  // namespace

void write_example_scans(const fs::path& dataset, const Parallel& parallel) {
  const auto truth = dataset::load_truth(dataset);
  const auto mesh = dataset::find_world_mesh(dataset);
  if (!truth || !mesh) throw InputError(dataset.string(), "has no truth or no mesh");
  const world::World world(world::load_mesh(*mesh), mesh->string());
  const Rig rig = open_any_dataset(dataset, {}, parallel).rig;
  for (const LidarInfo& lidar : rig.lidars) {
    dataset::ReadOptions read;
    read.sensor = lidar.id;
    const dataset::Dataset source = open_any_dataset(dataset, read, parallel);
    const std::size_t max_returns = evaluation::scored_returns(source.scan_count.value_or(0));
    Scan scan = scan_with_most_rotation(*source.events, lidar.id, *truth);
    evaluation::keep_scored(scan.points, max_returns);
    for (const bool skewed : {false, true}) {
      dataset::Cloud cloud =
          scan_in_world(scan, evaluation::LidarPoses(*truth, lidar.body_from_lidar), skewed);
      evaluation::map_error(cloud.points, Pose::Identity(), world, parallel, &cloud.distance);
      dataset::write_ply(dataset / (lidar.id + (skewed ? "_scan_skewed.ply" : "_scan.ply")), cloud);
    }
  }
}

}  // namespace lidarena::stages
