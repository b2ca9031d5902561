// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/odometry/fast_lio2/plane_residuals.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace lidarena::odometry::fast_lio2 {
namespace {

constexpr float kMaxSquaredDistance = 5.0F;  // m^2, of the farthest of the five
constexpr double kMaxThickness = 0.1;        // m, distance of one of the five from their plane
constexpr std::size_t kGrain = 64;           // points per task: about 0.1 ms of searches

/// The unit-offset fit has no plane through the world's origin.
std::optional<estimation::Plane> plane_through(const Neighbors& points) {
  return estimation::fit_plane(map::columns_of(points), kMaxThickness);
}

bool are_same_points(const Neighbors& a, const Neighbors& b) {
  return std::ranges::equal(a, b, {}, &map::Neighbor::point, &map::Neighbor::point);
}

/// Distance (m) within which `point` has at least these neighbors, whatever the rounding; infinite
/// if some are missing.
float distance_to_farthest(const Neighbors& neighbors, const Eigen::Vector3f& point) {
  float squared = 0.0F;
  for (const map::Neighbor& neighbor : neighbors) {
    if (std::isinf(neighbor.squared_distance)) return neighbor.squared_distance;
    squared = std::max(squared, (neighbor.point - point).squaredNorm());
  }
  constexpr float kRounding = 1.0F + 1e-5F;
  return kRounding * std::sqrt(squared) + std::numeric_limits<float>::min();
}

}  // namespace

PlaneResiduals::PlaneResiduals(std::span<const Eigen::Vector3f> points, const map::KdTree& map,
                               bool estimate_extrinsics, const Parallel& parallel)
    : points_(points),
      map_(map),
      estimate_extrinsics_(estimate_extrinsics),
      parallel_(parallel),
      neighbors_(points.size()),
      fitted_(points.size()),
      planes_(points.size()) {}

/// A search mostly finds the neighbors of the search before, of which the plane is known.
void PlaneResiduals::find(std::size_t i, const Eigen::Vector3f& point) {
  Neighbors nearest;
  map_.nearest(point, nearest, distance_to_farthest(neighbors_[i], point));
  if (!are_same_points(nearest, neighbors_[i])) fitted_[i] = plane_through(nearest);
  neighbors_[i] = nearest;
  const bool near = nearest.back().squared_distance <= kMaxSquaredDistance;
  planes_[i] = near ? fitted_[i] : std::nullopt;
}

estimation::NormalEquations<estimation::kPointDof> PlaneResiduals::operator()(
    const estimation::InertialState& state, bool search) {
  const Pose world_from_lidar = state.world_from_lidar();
  const auto find_planes = [&](std::size_t i) {
    const Eigen::Vector3d point = world_from_lidar * points_[i].cast<double>();
    find(i, point.cast<float>());
  };
  if (search) parallel_.for_each(points_.size(), kGrain, find_planes);
  return estimation::sum_residuals(points_, state, estimate_extrinsics_, planes_, parallel_);
}

}  // namespace lidarena::odometry::fast_lio2
