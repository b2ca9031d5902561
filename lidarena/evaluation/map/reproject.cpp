// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/evaluation/map/reproject.hpp"

#include <cmath>
#include <variant>
#include <vector>

#include "lidarena/map/occupied_voxels.hpp"

namespace lidarena::evaluation {
namespace {

const Eigen::Vector3f kNowhere = Eigen::Vector3f::Constant(NAN);  // rejected by the map

}  // namespace

ReprojectionCounts reproject(EventSource& events, const std::string& lidar_id,
                             const Pose& body_from_lidar, const BodyMotion& motion,
                             const std::function<void(const dataset::Cloud&)>& take,
                             double voxel_size_m) {
  LidarPoses poses(motion, body_from_lidar);
  map::OccupiedVoxels voxels(voxel_size_m);
  ReprojectionCounts seen;
  std::uint32_t scans = 0;
  std::vector<Eigen::Vector3f> placed;  // the scan's points in the world, kNowhere if dropped
  std::vector<std::uint32_t> added;     // indices of those that are new in the map
  while (const std::optional<Event> event = events.next()) {
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
    voxels.insert(placed, added);
    dataset::Cloud part;
    for (const std::uint32_t i : added) {
      part.points.push_back(placed[i]);
      part.intensity.push_back(scan->points[i].intensity);
      part.origins.push_back({scans, i, to_seconds(time_of(*scan, scan->points[i]))});
    }
    take(part);
    ++scans;
  }
  return seen;
}

dataset::Cloud reprojected(EventSource& events, const std::string& lidar_id,
                           const Pose& body_from_lidar, const BodyMotion& motion,
                           ReprojectionCounts* counts) {
  dataset::Cloud map;
  const auto append = [](auto& all, const auto& part) {
    all.insert(all.end(), part.begin(), part.end());
  };
  const ReprojectionCounts seen =
      reproject(events, lidar_id, body_from_lidar, motion, [&](const dataset::Cloud& part) {
        append(map.points, part.points);
        append(map.intensity, part.intensity);
        append(map.origins, part.origins);
      });
  if (counts != nullptr) *counts = seen;
  return map;
}

}  // namespace lidarena::evaluation
