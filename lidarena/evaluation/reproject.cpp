// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/evaluation/reproject.hpp"

#include <utility>
#include <variant>

#include "lidarena/evaluation/association.hpp"
#include "lidarena/map/point_map.hpp"

namespace lidarena {
namespace {

/// Poses of the LiDAR at instants that come in runs: a column of a spinning sensor fires at once.
class LidarPoses {
 public:
  LidarPoses(const Trajectory& estimate, const Pose& body_from_lidar)
      : estimate_(estimate), body_from_lidar_(body_from_lidar), bracket_(max_bracket(estimate)) {}

  /// nullptr where the estimate says nothing.
  const Eigen::Isometry3f* at(Time t) {
    if (!known_ || t != stamp_) look_up(t);
    return has_pose_ ? &pose_ : nullptr;
  }

 private:
  void look_up(Time t) {
    const std::optional<Pose> world_from_body = pose_between(estimate_, t, bracket_);
    known_ = true;
    stamp_ = t;
    has_pose_ = world_from_body.has_value();
    if (has_pose_) pose_ = (*world_from_body * body_from_lidar_).cast<float>();
  }

  const Trajectory& estimate_;
  Pose body_from_lidar_;
  Time bracket_;
  bool known_ = false;
  bool has_pose_ = false;
  Time stamp_{0};
  Eigen::Isometry3f pose_ = Eigen::Isometry3f::Identity();
};

}  // namespace

Cloud reproject(EventSource& events, const std::string& lidar_id, const Pose& body_from_lidar,
                const Trajectory& estimate, double voxel_m, ReprojectionCounts* counts) {
  LidarPoses poses(estimate, body_from_lidar);
  PointMap map(voxel_m);
  Cloud cloud;
  ReprojectionCounts seen;
  while (const std::optional<Event> event = events.next()) {
    const Scan* scan = std::get_if<Scan>(&event->data);
    if (scan == nullptr || event->sensor_id != lidar_id) continue;
    if (!scan->timed) ++seen.untimed_scans;
    seen.returns += scan->points.size();
    for (const Point& point : scan->points) {
      const Eigen::Isometry3f* world_from_lidar = poses.at(time_of(*scan, point));
      if (!point.position.allFinite()) {
        ++seen.not_finite;
      } else if (world_from_lidar == nullptr) {
        ++seen.without_pose;
      } else if (map.insert(*world_from_lidar * point.position)) {
        cloud.intensity.push_back(point.intensity);
      }
    }
  }
  cloud.points = map.take();
  if (counts != nullptr) *counts = seen;
  return cloud;
}

}  // namespace lidarena
