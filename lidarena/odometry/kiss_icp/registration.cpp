// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/odometry/kiss_icp/registration.hpp"

#include "lidarena/base/se3.hpp"
#include "lidarena/base/so3.hpp"
#include "lidarena/estimation/deskew.hpp"
#include "lidarena/estimation/least_squares.hpp"

namespace lidarena::odometry::kiss_icp {

namespace {

/// Geman-McClure weight as in the published program. It adds sigma (m) to a squared length (m^2),
/// so the kernel's actual scale is sqrt(sigma / 1 m) m.
double kernel_weight(double squared_error, double sigma) {
  const double ratio = sigma / (sigma + squared_error);
  return ratio * ratio;
}

/// The `sigma` for kernel_weight() when the configured scale is `scale` m.
double kernel_of(double scale, const Config& config) {
  return config.kernel_scale_in_meters ? scale * scale : scale;
}

/// Pose of the lidar at a point's instant, and the share of the scan's increment that applies to
/// it.
struct PoseShare {
  Pose map_from_instant;
  double share;
};

/// Motion of the lidar through the scan according to the current estimate.
class MovingFrame {
 public:
  MovingFrame(const Pose& pose, const se3::Vector6& twist, const TimedPoints& points,
              double share_per_second)
      : pose_(pose), points_(points), motion_(twist), share_per_second_(share_per_second) {}

  PoseShare at(std::size_t i) const {
    if (points_.deskewed()) return {pose_, 1.0};
    const double seconds = double{points_.seconds[i]};
    return {pose_ * motion_.at(seconds), 1.0 + share_per_second_ * seconds};
  }

 private:
  const Pose& pose_;
  const TimedPoints& points_;
  estimation::ConstantTwist motion_;
  double share_per_second_;
};

/// `increment` as a transform of the map frame, its rotation about `center`.
Pose apply_about(const se3::Vector6& increment, const Eigen::Vector3d& center) {
  return Eigen::Translation3d(center) * se3::exp(increment) * Eigen::Translation3d(-center);
}

}  // namespace

PointResidual point_to_point(const Eigen::Vector3d& point, const Eigen::Vector3d& counterpart,
                             const Eigen::Vector3d& center) {
  PointResidual residual;
  residual.error = point - counterpart;
  residual.jacobian << Eigen::Matrix3d::Identity(), -so3::hat(point - center);
  return residual;
}

se3::Vector6 twist_towards(const Pose& map_from_lidar, const PreviousPose& previous_pose,
                           double scan_motion_share) {
  if (previous_pose.seconds <= 0.0) return previous_pose.twist;
  const se3::Vector6 own =
      se3::log(previous_pose.map_from_lidar.inverse() * map_from_lidar) / previous_pose.seconds;
  return scan_motion_share * own + (1.0 - scan_motion_share) * previous_pose.twist;
}

Registration register_points(const TimedPoints& keypoints, const map::VoxelHashMap& map,
                             const PreviousPose& previous_pose, const Pose& guess, double sigma,
                             double scan_motion_share, const Config& config,
                             const Parallel& parallel) {
  Registration result{guess};
  if (map.empty()) return result;
  const auto radius = static_cast<float>(3.0 * sigma);
  const double kernel = kernel_of(sigma * config.kernel_fraction, config);
  const double share_per_second =
      previous_pose.seconds > 0.0 ? scan_motion_share / previous_pose.seconds : 0.0;
  Pose& pose = result.map_from_lidar;
  while (result.iterations < config.max_iterations) {
    result.twist = twist_towards(pose, previous_pose, scan_motion_share);
    const MovingFrame frame(pose, result.twist, keypoints, share_per_second);
    const auto add_match = [&](std::size_t i, estimation::NormalEquations<6>& equations) {
      const auto [map_from_instant, share] = frame.at(i);
      const Eigen::Vector3d point = map_from_instant * keypoints.positions[i].cast<double>();
      const auto match = map.nearest(point.cast<float>(), radius);
      if (!match) return;
      const Eigen::Vector3d center = config.sensor_centered
                                         ? Eigen::Vector3d(map_from_instant.translation())
                                         : Eigen::Vector3d::Zero();
      if (match.plane != nullptr) {
        const auto [error, jacobian] =
            point_to_point(point, match.plane->mean.cast<double>(), center);
        const Eigen::Vector3d normal = match.plane->normal.cast<double>();
        const Eigen::Matrix<double, 1, 1> distance(normal.dot(error));
        equations.add<1>(share * normal.transpose() * jacobian, distance,
                         kernel_weight(distance.squaredNorm(), kernel));
        return;
      }
      const auto [error, jacobian] = point_to_point(point, match.point.cast<double>(), center);
      const double weight = match.degenerate ? config.degenerate_cell_weight : 1.0;
      equations.add<3>(share * jacobian, error,
                       weight * kernel_weight(error.squaredNorm(), kernel));
    };
    const auto equations =
        estimation::accumulate_normal_equations<6>(parallel, keypoints.size(), add_match);
    const Eigen::Vector3d center =
        config.sensor_centered ? Eigen::Vector3d(pose.translation()) : Eigen::Vector3d::Zero();
    const se3::Vector6 increment = equations.solve();
    pose = orthonormalized(apply_about(increment, center) * pose);
    result.matches = equations.count;
    ++result.iterations;
    if (increment.norm() < config.convergence) break;
  }
  return result;
}

}  // namespace lidarena::odometry::kiss_icp
