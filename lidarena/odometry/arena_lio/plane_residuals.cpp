// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/odometry/arena_lio/plane_residuals.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "lidarena/estimation/point_to_plane.hpp"
#include "lidarena/estimation/robust_kernel.hpp"

namespace lidarena::odometry::arena_lio {
namespace {

constexpr std::size_t kGrain = 512;     // points per task of a search
constexpr double kNarrowing = 0.4;      // of the kernel, from one evaluation to the next
constexpr double kMaxScale = 30.0;      // m, of the kernel, also if the prior is not finite
constexpr double kCut = 6.0;            // scales of the kernel; points beyond have no weight
constexpr double kMinFineShare = 0.02;  // of points that determine each direction by fine planes

double distance(const map::MapPlane& plane, const Eigen::Vector3f& point) {
  return plane.normal.dot(point - plane.center);
}

estimation::Plane as_equation(const map::MapPlane& plane) {
  const Eigen::Vector3d normal = plane.normal.cast<double>();
  return {normal, -normal.dot(plane.center.cast<double>())};
}

/// Number of planes that determine the position in the direction in which it is determined least:
/// smallest eigenvalue of the sum of n n^T.
double weakest_direction(const std::vector<const map::MapPlane*>& planes) {
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  for (const map::MapPlane* plane : planes) {
    if (plane == nullptr) continue;
    const Eigen::Vector3d normal = plane->normal.cast<double>();
    sum += normal * normal.transpose();
  }
  return Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(sum, Eigen::EigenvaluesOnly)
      .eigenvalues()[0];
}

std::size_t count_planes(const std::vector<const map::MapPlane*>& planes) {
  return planes.size() - static_cast<std::size_t>(std::ranges::count(planes, nullptr));
}

}  // namespace

PlaneResiduals::PlaneResiduals(std::span<const Eigen::Vector3f> points,
                               std::span<const Eigen::Vector3f> seen_from,
                               const map::LocalPlanes& map, double prior_sigma,
                               bool with_extrinsics, const Config& config, const Parallel& parallel)
    : points_(points),
      seen_from_(seen_from),
      map_(map),
      config_(config),
      parallel_(parallel),
      with_extrinsics_(with_extrinsics),
      knew_the_place_(prior_sigma < config.kernel_scale_m),
      scale_(std::min(std::max(config.kernel_scale_m, prior_sigma), kMaxScale)),
      in_map_(points.size()),
      planes_(points.size()) {}

void PlaneResiduals::find_planes(const Pose& world_from_lidar, bool with_coarse) {
  // A place that is uncertain by more than a fine plane's neighborhood has fine cells of elsewhere.
  const bool uncertain = scale_ > config_.kernel_scale_m;
  const map::PlaneMap& first = uncertain ? map_.coarse() : map_.fine();
  const map::PlaneMap& second = uncertain ? map_.fine() : map_.coarse();
  const auto in_map = [&](const Eigen::Vector3f& point) -> Eigen::Vector3f {
    return (world_from_lidar * point.cast<double>()).cast<float>();
  };
  parallel_.for_each(points_.size(), kGrain, [&](std::size_t i) {
    in_map_[i] = in_map(points_[i]);
    planes_[i] = first.plane_at(in_map_[i], in_map(seen_from_[i]));
  });
  const double needed = kMinFineShare * static_cast<double>(points_.size());
  if (!uncertain && !with_coarse && weakest_direction(planes_) >= needed) return;
  parallel_.for_each(points_.size(), kGrain, [&](std::size_t i) {
    if (planes_[i] == nullptr) planes_[i] = second.plane_at(in_map_[i], in_map(seen_from_[i]));
  });
}

int PlaneResiduals::narrowing() const {
  return static_cast<int>(
      std::ceil(std::log(config_.kernel_scale_m / scale_) / std::log(kNarrowing)));
}

estimation::NormalEquations<estimation::kPointDof> PlaneResiduals::operator()(
    const estimation::InertialState& state, bool /*search*/) {
  find_planes(state.world_from_lidar());
  const double variance = config_.point_variance_m2;
  auto sums = estimation::accumulate_normal_equations<estimation::kPointDof>(
      parallel_, points_.size(), [&](std::size_t i, auto& sum) {
        const map::MapPlane* plane = planes_[i];
        if (plane == nullptr || std::abs(distance(*plane, in_map_[i])) > kCut * scale_) return;
        const estimation::PointResidual residual = estimation::point_residual(
            points_[i].cast<double>(), as_equation(*plane), state, with_extrinsics_);
        const double of_plane = variance / std::max(variance, static_cast<double>(plane->variance));
        sum.template add<1>(residual.row, Eigen::Matrix<double, 1, 1>(residual.distance),
                            of_plane * estimation::geman_mcclure_weight(residual.distance, scale_));
      });
  scale_ = std::max(kNarrowing * scale_, config_.kernel_scale_m);
  return sums;
}

Agreement PlaneResiduals::agreement(const estimation::InertialState& state) {
  scale_ = config_.kernel_scale_m;
  find_planes(state.world_from_lidar());
  Agreement agreement{.points = points_.size(), .near_planes = count_planes(planes_)};
  for (std::size_t i = 0; i < planes_.size(); ++i) {
    const bool is_near = planes_[i] != nullptr;
    if (is_near && std::abs(distance(*planes_[i], in_map_[i])) < config_.kernel_scale_m)
      ++agreement.on_planes;
  }
  const Eigen::Vector3f sensor = state.world_from_lidar().translation().cast<float>();
  agreement.contacts = contacts_of(in_map_, sensor, map_, config_.kernel_scale_m);
  agreement.expected = knew_the_place_ ? agreement.near_planes : agreement.points;
  return agreement;
}

}  // namespace lidarena::odometry::arena_lio
