// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/odometry/fast_lio2/plane_residuals.hpp"

namespace lidarena::odometry::fast_lio2 {
namespace {

constexpr float kMaxSquaredDistance = 5.0F;  // m^2, of the farthest of the five
constexpr double kMaxThickness = 0.1;        // m, distance of one of the five from their plane
constexpr std::size_t kGrain = 64;           // points per task: about 0.1 ms of searches

/// The unit-offset fit has no plane through the world's origin.
std::optional<estimation::WeightedPlane> plane_through(const Neighbors& points) {
  if (!(points.back().squared_distance <= kMaxSquaredDistance)) return std::nullopt;
  const auto plane = estimation::fit_plane(map::columns_of(points),
                                           estimation::PlaneFit::kUnitOffset, kMaxThickness);
  if (!plane) return std::nullopt;
  return estimation::WeightedPlane{*plane};
}

}  // namespace

PlaneResiduals::PlaneResiduals(std::span<const Eigen::Vector3f> points, const map::KdTree& map,
                               bool estimate_extrinsics, const Parallel& parallel)
    : points_(points),
      map_(map),
      estimate_extrinsics_(estimate_extrinsics),
      parallel_(parallel),
      neighbors_(points.size()),
      planes_(points.size()) {}

estimation::NormalEquations<estimation::kPointDof> PlaneResiduals::operator()(
    const estimation::InertialState& state, bool search) {
  const Pose world_from_lidar = state.world_from_lidar();
  const auto find = [&](std::size_t i) {
    const Eigen::Vector3d point = world_from_lidar * points_[i].cast<double>();
    map_.nearest(point.cast<float>(), neighbors_[i]);
    planes_[i] = plane_through(neighbors_[i]);
  };
  if (search) parallel_.for_each(points_.size(), kGrain, find);
  return estimation::sum_residuals(points_, state, estimate_extrinsics_, planes_, parallel_);
}

}  // namespace lidarena::odometry::fast_lio2
