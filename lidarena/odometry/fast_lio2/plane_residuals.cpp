// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/odometry/fast_lio2/plane_residuals.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

namespace lidarena::fast_lio2 {
namespace {

using Columns = Eigen::Matrix<double, 3, kNeighbors>;

/// Least-squares solution of a . x = -1.
Plane through_origin(const Columns& points) {
  const Eigen::Matrix<float, kNeighbors, 3> rows = points.transpose().cast<float>();
  const Eigen::Vector3f a =
      rows.colPivHouseholderQr().solve(Eigen::Matrix<float, kNeighbors, 1>::Constant(-1.0F));
  const double length = a.cast<double>().norm();
  return {a.cast<double>() / length, 1.0 / length};
}

/// Through the centroid, normal along the direction of the points' smallest spread.
Plane principal(const Columns& points) {
  const Eigen::Vector3d center = points.rowwise().mean();
  const Columns centered = points.colwise() - center;
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> spread;
  spread.computeDirect(centered * centered.transpose());
  const Eigen::Vector3d normal = spread.eigenvectors().col(0);
  return {normal, -normal.dot(center)};
}

/// Whether the residual is small for the point's range: 0.11 m at 1 m, 0.35 m at 10 m.
bool is_near(double distance, double range) {
  return 1.0 - 0.9 * std::abs(distance) / std::sqrt(range) > 0.9;
}

}  // namespace

std::optional<Plane> fit_plane(const Neighbors& points, PlaneFit fit, double thickness) {
  Columns columns;
  for (std::size_t i = 0; i < kNeighbors; ++i) {
    columns.col(static_cast<Eigen::Index>(i)) = points[i].point.cast<double>();
  }
  const Plane plane = fit == PlaneFit::kPrincipal ? principal(columns) : through_origin(columns);
  const auto distances = (plane.normal.transpose() * columns).array() + plane.offset;
  // Negated comparison, because a failed fit is not finite.
  if (!(distances.abs().maxCoeff() <= thickness)) return std::nullopt;
  return plane;
}

double plane_variance(const Neighbors& points, const Plane& plane, double point_variance) {
  Eigen::Vector3d center = Eigen::Vector3d::Zero();
  for (const Neighbor& p : points) center += p.point.cast<double>() / kNeighbors;
  const Eigen::Matrix<double, 3, 2> basis = tangent_basis(plane.normal);
  Eigen::Matrix2d spread = Eigen::Matrix2d::Zero();  // along the plane
  double reach = 0.0;
  for (const Neighbor& p : points) {
    const Eigen::Vector2d along = basis.transpose() * (p.point.cast<double>() - center);
    spread += along * along.transpose();
    reach = std::max(reach, along.squaredNorm());
  }
  const double half = 0.5 * spread.trace();
  const double width = half - std::sqrt(std::max(0.0, half * half - spread.determinant()));
  const double tilt = point_variance / std::max(width, 1e-3 * point_variance);
  return point_variance / kNeighbors + tilt * reach;
}

PointResidual point_residual(const Eigen::Vector3d& point, const Plane& plane,
                             const InertialState& state, bool extrinsics) {
  const Eigen::Vector3d in_imu = state.lidar_rotation * point + state.lidar_position;
  const Eigen::Vector3d in_world = state.rotation * in_imu + state.position;
  const Eigen::Vector3d normal_in_imu = state.rotation.transpose() * plane.normal;
  PointResidual residual{plane.normal.dot(in_world) + plane.offset, {}};
  residual.row << plane.normal.transpose(), in_imu.cross(normal_in_imu).transpose(),
      Eigen::Matrix<double, 1, 6>::Zero();
  if (extrinsics) {
    residual.row.tail<6>()
        << point.cross(state.lidar_rotation.transpose() * normal_in_imu).transpose(),
        normal_in_imu.transpose();
  }
  return residual;
}

PlaneResiduals::PlaneResiduals(std::span<const Eigen::Vector3f> points, const KdTree& map,
                               const Config& config, const Parallel& parallel)
    : points_(points), map_(map), config_(config), parallel_(parallel), matches_(points.size()) {}

void PlaneResiduals::find(const Eigen::Vector3f& in_world, Match& match) const {
  match.found = map_.nearest(in_world, match.neighbors, static_cast<float>(config_.max_neighbor_m));
  match.plane.reset();
  if (match.found == kNeighbors) {
    match.plane = fit_plane(match.neighbors, config_.plane_fit, config_.plane_thickness_m);
  }
  match.near_plane = match.plane.has_value();
  if (!match.plane || !config_.plane_uncertainty) return;
  const double own = config_.point_variance_m2;
  match.weight = own / (own + plane_variance(match.neighbors, *match.plane, own));
}

double PlaneResiduals::near_planes() const {
  return static_cast<double>(std::count_if(matches_.begin(), matches_.end(),
                                           [](const Match& match) { return match.near_plane; }));
}

NormalEquations<kPointDof> PlaneResiduals::operator()(const InertialState& state, bool search) {
  const Pose world_from_lidar = state.world_from_lidar();
  return accumulate_normal_equations<kPointDof>(
      parallel_, points_.size(), [&](std::size_t i, NormalEquations<kPointDof>& sum) {
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

}  // namespace lidarena::fast_lio2
