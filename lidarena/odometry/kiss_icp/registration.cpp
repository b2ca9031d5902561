// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/odometry/kiss_icp/registration.hpp"

#include "lidarena/base/se3.hpp"
#include "lidarena/base/so3.hpp"
#include "lidarena/estimation/least_squares.hpp"

namespace lidarena::odometry::kiss_icp {

PointResidual point_to_point(const Eigen::Vector3d& point, const Eigen::Vector3d& counterpart) {
  PointResidual residual;
  residual.error = point - counterpart;
  residual.jacobian << Eigen::Matrix3d::Identity(), -so3::hat(point);
  return residual;
}

double kernel_weight(double squared_error, double scale) {
  const double ratio = scale / (scale + squared_error);
  return ratio * ratio;
}

IcpLimits icp_limits(double sigma, const Config& config) {
  return {3.0 * sigma, kernel_scale(config.release, sigma), config.max_iterations,
          config.convergence};
}

Registration register_points(const Points& keypoints, const map::VoxelHashMap& map,
                             const Pose& guess, const IcpLimits& limits, const Parallel& parallel) {
  Registration result{guess};
  if (map.empty()) return result;
  const auto radius = static_cast<float>(limits.max_distance_m);
  Pose& pose = result.map_from_lidar;
  const auto add_match = [&](std::size_t i, estimation::NormalEquations<6>& equations) {
    const Eigen::Vector3d point = pose * keypoints[i].cast<double>();
    const auto match = map.nearest(point.cast<float>(), radius);
    if (!match) return;
    const PointResidual residual = point_to_point(point, match->point.cast<double>());
    equations.add<3>(residual.jacobian, residual.error,
                     kernel_weight(residual.error.squaredNorm(), limits.kernel_scale));
  };
  while (result.iterations < limits.max_iterations) {
    const auto equations =
        estimation::accumulate_normal_equations<6>(parallel, keypoints.size(), add_match);
    const se3::Vector6 increment = equations.solve();
    pose = orthonormalized(se3::exp(increment) * pose);
    result.matches = equations.count;
    ++result.iterations;
    if (increment.norm() < limits.convergence) break;
  }
  return result;
}

}  // namespace lidarena::odometry::kiss_icp
