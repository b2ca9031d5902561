// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "lidarena/base/parallel.hpp"
#include "lidarena/base/pose.hpp"
#include "lidarena/base/scan.hpp"
#include "lidarena/base/trajectory.hpp"
#include "lidarena/estimation/scan_times.hpp"

namespace lidarena::odometry::ct_icp {

/// Motion of the lidar during one scan: a pose at its first and one at its last instant, between
/// them linear in position and spherical-linear in rotation (CT-ICP, III-B).
struct ElasticMotion {
  Pose begin = Pose::Identity();
  Pose end = Pose::Identity();

  static ElasticMotion still(const Pose& pose) { return {pose, pose}; }
  /// Pose at `alpha`: 0 first, 1 last instant of the scan.
  Pose at(double alpha) const;
};

/// Difference between two motions: sums over begin and end.
struct MotionChange {
  double translation_m = 0.0;
  double rotation_rad = 0.0;
};
MotionChange change_between(const ElasticMotion& a, const ElasticMotion& b);

/// An ElasticMotion with precomputed coefficients: transforming a point costs one sine and one
/// cosine. `alpha` in [0, 1] goes from the scan's first to its last instant.
class ElasticTrack {
 public:
  using Row = Eigen::Matrix<double, 1, 12>;

  explicit ElasticTrack(const ElasticMotion& motion);

  /// World position of a point (m, lidar frame) measured at `alpha`.
  Eigen::Vector3d place(const Eigen::Vector3d& point, double alpha) const;

  /// Derivative of direction . place(point, alpha) with respect to left increments (translation,
  /// rotation about the pose's own position) of begin and end, in this order. Exact, with the
  /// Jacobian of the slerp.
  Row row(const Eigen::Vector3d& point, double alpha, const Eigen::Vector3d& direction) const;

 private:
  Eigen::Matrix3d from_;
  Eigen::Vector3d begin_;
  Eigen::Vector3d step_;
  Eigen::Vector3d axis_ = Eigen::Vector3d::UnitZ();  ///< unit, world
  double angle_ = 0.0;                               ///< rad
  double half_cotangent_ = 0.0;                      ///< 1 - angle / 2 cot(angle / 2)
};

/// A point of a scan and its instant within the scan.
struct TimedPoint {
  Eigen::Vector3f position;  ///< m, lidar frame at its own instant
  float alpha;               ///< 0 the scan's first instant, 1 its last
};

/// The scan's finite points. In a `rigid` scan all have alpha 1, as if it was taken at its last
/// instant.
std::vector<TimedPoint> timed_points(const Scan& scan, const estimation::ScanTimes& times,
                                     bool rigid);

/// World positions (m) of points of a scan with this motion, in the frame that `by` transforms the
/// motion's to.
std::vector<Eigen::Vector3f> placed(const Pose& by, const ElasticMotion& motion,
                                    std::span<const TimedPoint> points, const Parallel& parallel);

/// Poses of the body at begin and end of a motion of the lidar. World: the body's frame at the pose
/// at which the lidar's motion is the identity.
std::vector<StampedPose> body_poses(const ElasticMotion& motion, const estimation::ScanTimes& times,
                                    const Pose& body_from_lidar);

}  // namespace lidarena::odometry::ct_icp
