// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/odometry/kiss_icp/registration.hpp"

#include "lidarena/base/se3.hpp"
#include "lidarena/base/so3.hpp"
#include "lidarena/estimation/least_squares.hpp"

namespace lidarena::kiss_icp {

namespace {

/// The public program's Geman-McClure weight. Its sigma (m) is added to a squared length (m^2), so
/// the kernel's real scale is sqrt(sigma / 1 m) m.
double kernel_weight(double squared_error, double sigma) {
  const double ratio = sigma / (sigma + squared_error);
  return ratio * ratio;
}

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

Registration register_points(std::span<const Eigen::Vector3f> keypoints, const VoxelHashMap& map,
                             const Pose& guess, double sigma, const Config& config,
                             const Parallel& parallel) {
  Registration result{guess};
  if (map.empty()) return result;
  const auto radius = static_cast<float>(3.0 * sigma);
  const double kernel = sigma * config.kernel_fraction;
  Pose& pose = result.map_from_lidar;
  while (result.iterations < config.max_iterations) {
    const Eigen::Vector3d center =
        config.sensor_centred ? Eigen::Vector3d(pose.translation()) : Eigen::Vector3d::Zero();
    const auto add_match = [&](std::size_t i, NormalEquations<6>& equations) {
      const Eigen::Vector3d point = pose * keypoints[i].cast<double>();
      const auto match = map.nearest(point.cast<float>(), radius);
      if (!match) return;
      const auto [error, jacobian] = point_to_point(point, match.point->cast<double>(), center);
      equations.add<3>(jacobian, error, kernel_weight(error.squaredNorm(), kernel));
    };
    const auto equations = accumulate_normal_equations<6>(parallel, keypoints.size(), add_match);
    const se3::Vector6 increment = equations.solve();
    pose = orthonormalized(apply_about(increment, center) * pose);
    result.matches = equations.count;
    ++result.iterations;
    if (increment.norm() < config.convergence) break;
  }
  return result;
}

}  // namespace lidarena::kiss_icp
