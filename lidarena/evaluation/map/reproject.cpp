// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/evaluation/map/reproject.hpp"

#include <cmath>
#include <utility>
#include <variant>

#include "lidarena/map/point_map.hpp"

namespace lidarena::evaluation {
namespace {

const Eigen::Vector3f kNowhere = Eigen::Vector3f::Constant(NAN);  // rejected by the map

}  // namespace

dataset::Cloud reproject(dataset::EventSource& events, const std::string& lidar_id,
                         const Pose& body_from_lidar, const BodyMotion& motion, double voxel_size_m,
                         ReprojectionCounts* counts, std::vector<ReturnOrigin>* origins) {
  LidarPoses poses(motion, body_from_lidar);
  map::PointMap map(voxel_size_m);
  dataset::Cloud cloud;
  ReprojectionCounts seen;
  std::uint32_t scans = 0;
  std::vector<Eigen::Vector3f> placed;  // the scan's points in the world, kNowhere if dropped
  std::vector<std::uint32_t> added;     // indices of those that were added to the map
  while (const std::optional<dataset::Event> event = events.next()) {
    const Scan* scan = std::get_if<Scan>(&event->data);
    if (scan == nullptr || event->sensor_id != lidar_id) continue;
    if (!scan->timed) ++seen.untimed_scans;
    seen.returns += scan->points.size();
    placed.clear();
    for (const Point& point : scan->points) {
      const Pose* world_from_lidar = poses.at(time_of(*scan, point));
      if (!point.position.allFinite()) {
        ++seen.not_finite;
        placed.push_back(kNowhere);
      } else if (world_from_lidar == nullptr) {
        ++seen.without_pose;
        placed.push_back(kNowhere);
      } else {
        placed.push_back((*world_from_lidar * point.position.cast<double>()).cast<float>());
      }
    }
    added.clear();
    map.insert(placed, &added);
    for (const std::uint32_t i : added) {
      cloud.intensity.push_back(scan->points[i].intensity);
      if (origins != nullptr) origins->push_back({scans, i});
    }
    ++scans;
  }
  cloud.points = map.take();
  if (counts != nullptr) *counts = seen;
  return cloud;
}

}  // namespace lidarena::evaluation
