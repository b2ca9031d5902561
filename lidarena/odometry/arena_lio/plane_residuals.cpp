// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/odometry/arena_lio/plane_residuals.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

namespace lidarena::odometry::arena_lio {
namespace {

/// Whether the residual is small for the point's range: 0.11 m at 1 m, 0.35 m at 10 m.
bool is_near(double distance, double range) {
  return 1.0 - 0.9 * std::abs(distance) / std::sqrt(range) > 0.9;
}

}  // namespace

double plane_variance(const Neighbors& points, const estimation::Plane& plane,
                      double point_variance) {
  Eigen::Vector3d center = Eigen::Vector3d::Zero();
  for (const map::Neighbor& p : points) center += p.point.cast<double>() / kNeighbors;
  const Eigen::Matrix<double, 3, 2> basis = estimation::tangent_basis(plane.normal);
  Eigen::Matrix2d spread = Eigen::Matrix2d::Zero();  // along the plane
  double reach = 0.0;
  for (const map::Neighbor& p : points) {
    const Eigen::Vector2d along = basis.transpose() * (p.point.cast<double>() - center);
    spread += along * along.transpose();
    reach = std::max(reach, along.squaredNorm());
  }
  const double half = 0.5 * spread.trace();
  const double width = half - std::sqrt(std::max(0.0, half * half - spread.determinant()));
  const double tilt = point_variance / std::max(width, 1e-3 * point_variance);
  return point_variance / kNeighbors + tilt * reach;
}

PointResidual point_residual(const Eigen::Vector3d& point, const estimation::Plane& plane,
                             const estimation::InertialState& state, bool extrinsics) {
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

PlaneResiduals::PlaneResiduals(std::span<const Eigen::Vector3f> points, const map::KdTree& map,
                               const Config& config, const Parallel& parallel)
    : points_(points), map_(map), config_(config), parallel_(parallel), matches_(points.size()) {}

void PlaneResiduals::find(const Eigen::Vector3f& in_world, Match& match) const {
  match.found =
      map_.nearest(in_world, match.neighbors, static_cast<float>(config_.max_neighbor_distance_m));
  match.plane.reset();
  if (match.found == kNeighbors) {
    match.plane = estimation::fit_plane(map::columns_of(match.neighbors), config_.plane_fit,
                                        config_.max_plane_thickness_m);
  }
  match.near_plane = match.plane.has_value();
  if (!match.plane || !config_.plane_uncertainty) return;
  const double own = config_.point_variance_m2;
  match.weight = own / (own + plane_variance(match.neighbors, *match.plane, own));
}

std::size_t PlaneResiduals::near_planes() const {
  return static_cast<std::size_t>(std::count_if(
      matches_.begin(), matches_.end(), [](const Match& match) { return match.near_plane; }));
}

estimation::NormalEquations<estimation::kPointDof> PlaneResiduals::operator()(
    const estimation::InertialState& state, bool search) {
  const Pose world_from_lidar = state.world_from_lidar();
  return estimation::accumulate_normal_equations<estimation::kPointDof>(
      parallel_, points_.size(),
      [&](std::size_t i, estimation::NormalEquations<estimation::kPointDof>& sum) {
        const Eigen::Vector3d point = points_[i].cast<double>();
        Match& match = matches_[i];
        if (search) find((world_from_lidar * point).cast<float>(), match);
        if (!match.plane) return;
        const PointResidual residual =
            point_residual(point, *match.plane, state, config_.estimate_extrinsics);
        if (!is_near(residual.distance, point.norm())) {
          match.plane.reset();
          return;
        }
        sum.add<1>(residual.row, Eigen::Matrix<double, 1, 1>(residual.distance), match.weight);
      });
}

}  // namespace lidarena::odometry::arena_lio
