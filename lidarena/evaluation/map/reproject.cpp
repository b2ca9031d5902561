// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/evaluation/map/reproject.hpp"

#include <utility>
#include <variant>

#include "lidarena/evaluation/map/lidar_poses.hpp"
#include "lidarena/map/point_map.hpp"

namespace lidarena::evaluation {

dataset::Cloud reproject(dataset::EventSource& events, const std::string& lidar_id,
                         const Pose& body_from_lidar, const Trajectory& estimate,
                         double voxel_size_m, ReprojectionCounts* counts,
                         std::vector<ReturnOrigin>* origins) {
  LidarPoses poses(estimate, body_from_lidar);
  map::PointMap map(voxel_size_m);
  dataset::Cloud cloud;
  ReprojectionCounts seen;
  std::uint32_t scans = 0;
  while (const std::optional<dataset::Event> event = events.next()) {
    const Scan* scan = std::get_if<Scan>(&event->data);
    if (scan == nullptr || event->sensor_id != lidar_id) continue;
    if (!scan->timed) ++seen.untimed_scans;
    seen.returns += scan->points.size();
    const std::uint32_t number = scans++;
    for (const Point& point : scan->points) {
      const Pose* world_from_lidar = poses.at(time_of(*scan, point));
      if (!point.position.allFinite()) {
        ++seen.not_finite;
      } else if (world_from_lidar == nullptr) {
        ++seen.without_pose;
      } else if (map.insert((*world_from_lidar * point.position.cast<double>()).cast<float>())) {
        cloud.intensity.push_back(point.intensity);
        if (origins == nullptr) continue;
        origins->push_back({number, static_cast<std::uint32_t>(&point - scan->points.data())});
      }
    }
  }
  cloud.points = map.take();
  if (counts != nullptr) *counts = seen;
  return cloud;
}

}  // namespace lidarena::evaluation
