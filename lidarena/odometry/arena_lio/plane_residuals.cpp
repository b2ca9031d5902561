// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/odometry/arena_lio/plane_residuals.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

namespace lidarena::odometry::arena_lio {
namespace {

constexpr std::size_t kGrain = 64;  // points per task of a search: about 0.1 ms

}  // namespace

double plane_variance(const std::array<map::Neighbor, kNeighbors>& points,
                      const estimation::Plane& plane, double point_variance) {
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

PlaneResiduals::PlaneResiduals(std::span<const Eigen::Vector3f> points, const map::KdTree& map,
                               const Config& config, const Parallel& parallel)
    : points_(points),
      map_(map),
      config_(config),
      parallel_(parallel),
      nearest_(points.size()),
      planes_(points.size()) {}

std::optional<estimation::WeightedPlane> PlaneResiduals::plane_of(const Nearest& nearest) const {
  if (nearest.found < kNeighbors) return std::nullopt;
  const auto plane =
      estimation::fit_plane(map::columns_of(nearest.points), estimation::PlaneFit::kPrincipal,
                            config_.max_plane_thickness_m);
  if (!plane) return std::nullopt;
  const double own = config_.point_variance_m2;
  return {{*plane, own / (own + plane_variance(nearest.points, *plane, own))}};
}

void PlaneResiduals::find_planes(const Pose& world_from_lidar) {
  const auto reach = static_cast<float>(config_.max_neighbor_distance_m);
  parallel_.for_each(points_.size(), kGrain, [&](std::size_t i) {
    const Eigen::Vector3f in_world = (world_from_lidar * points_[i].cast<double>()).cast<float>();
    nearest_[i].found = map_.nearest(in_world, nearest_[i].points, reach);
    planes_[i] = plane_of(nearest_[i]);
  });
  near_planes_ = static_cast<std::size_t>(std::count_if(
      planes_.begin(), planes_.end(), [](const auto& plane) { return plane.has_value(); }));
}

estimation::NormalEquations<estimation::kPointDof> PlaneResiduals::operator()(
    const estimation::InertialState& state, bool search) {
  if (search) find_planes(state.world_from_lidar());
  return estimation::sum_residuals(points_, state, config_.estimate_extrinsics, planes_, parallel_);
}

}  // namespace lidarena::odometry::arena_lio
