// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/estimation/point_to_plane.hpp"

#include <Eigen/Geometry>
#include <cmath>

namespace lidarena::estimation {

PointResidual point_residual(const Eigen::Vector3d& point, const Plane& plane,
                             const InertialState& state, bool extrinsics) {
  const Eigen::Vector3d in_imu =
      state.imu_from_lidar.linear() * point + state.imu_from_lidar.translation();
  const Eigen::Vector3d in_world = state.rotation() * in_imu + state.position();
  const Eigen::Vector3d normal_in_imu = state.rotation().transpose() * plane.normal;
  PointResidual residual{plane.normal.dot(in_world) + plane.offset, {}};
  residual.row << plane.normal.transpose(), in_imu.cross(normal_in_imu).transpose(),
      Eigen::Matrix<double, 1, 6>::Zero();
  if (extrinsics) {
    residual.row.tail<6>()
        << point.cross(state.imu_from_lidar.linear().transpose() * normal_in_imu).transpose(),
        normal_in_imu.transpose();
  }
  return residual;
}

bool is_inlier(double distance, double range) {
  return 1.0 - 0.9 * std::abs(distance) / std::sqrt(range) > 0.9;
}

namespace {

/// The sum in the first N unknowns.
template <int N>
NormalEquations<N> sum_in(std::span<const Eigen::Vector3f> points, const InertialState& state,
                          PointPlanes& planes, const Parallel& parallel) {
  return accumulate_normal_equations<N>(
      parallel, points.size(), [&](std::size_t i, NormalEquations<N>& sum) {
        std::optional<Plane>& plane = planes[i];
        if (!plane) return;
        const Eigen::Vector3d point = points[i].cast<double>();
        const PointResidual residual = point_residual(point, *plane, state, N > 6);
        if (!is_inlier(residual.distance, point.norm())) {
          plane.reset();
          return;
        }
        const Eigen::Matrix<double, 1, N> row = residual.row.template head<N>();
        sum.template add<1>(row, Eigen::Matrix<double, 1, 1>(residual.distance), 1.0);
      });
}

}  // namespace

NormalEquations<kPointDof> sum_residuals(std::span<const Eigen::Vector3f> points,
                                         const InertialState& state, bool extrinsics,
                                         PointPlanes& planes, const Parallel& parallel) {
  if (extrinsics) return sum_in<kPointDof>(points, state, planes, parallel);
  const NormalEquations<6> of_pose = sum_in<6>(points, state, planes, parallel);
  NormalEquations<kPointDof> sum;
  sum.hessian.topLeftCorner<6, 6>() = of_pose.hessian;
  sum.gradient.head<6>() = of_pose.gradient;
  sum.cost = of_pose.cost;
  sum.count = of_pose.count;
  return sum;
}

}  // namespace lidarena::estimation
