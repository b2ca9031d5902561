// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/odometry/kiss_icp_steps.hpp"

#include <bit>
#include <cmath>

#include "lidarena/base/so3.hpp"
#include "lidarena/estimation/deskew.hpp"
#include "lidarena/estimation/least_squares.hpp"
#include "lidarena/map/hash_order.hpp"
#include "lidarena/map/random_thinning.hpp"
#include "lidarena/map/voxel_filter.hpp"

namespace lidarena::odometry::kiss_icp {

se3::Vector6 twist_within(const estimation::ScanTimes& times, const Pose& motion) {
  if (!times.timed) return se3::Vector6::Zero();
  return se3::log(motion) / times.seconds();
}

Points in_range(const Points& points, const Config& config) {
  Points kept;
  kept.reserve(points.size());
  for (const Eigen::Vector3f& point : points) {
    const double range = point.cast<double>().norm();
    if (config.min_range_m < range && range < config.max_range_m) kept.push_back(point);
  }
  return kept;
}

Points preprocess(const Scan& scan, const estimation::ScanTimes& times,
                  const std::optional<se3::Vector6>& twist, Time instant, const Config& config,
                  const Parallel& parallel) {
  if (!twist) return in_range(estimation::positions(scan), config);
  if (!times.timed) return {};
  return in_range(estimation::deskew(scan, *twist, instant, parallel), config);
}

Points thin(const Points& points, double voxel_size, const CellOrder& order) {
  const auto inverse_size = static_cast<float>(1.0 / voxel_size);
  const auto first = map::first_of_each_voxel(points, voxel_size, order.rounding);
  const Points kept = map::selected<Eigen::Vector3f>(points, first);
  std::vector<std::uint32_t> hashes;
  for (const Eigen::Vector3f& point : kept)
    hashes.push_back(
        map::spatial_hash(map::voxel_of(point, inverse_size, order.rounding), order.hash_factor_y));
  const std::size_t slots = std::bit_ceil(2 * points.size());  // at least two per point
  return map::selected<Eigen::Vector3f>(kept, map::robin_hood_order(hashes, slots));
}

double displacement(const Pose& error, double range) {
  return error.translation().norm() + 2.0 * range * std::sin(0.5 * so3::angle(error.linear()));
}

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

IcpLimits icp_limits(double sigma, double kernel_scale, const Config& config) {
  return {3.0 * sigma, kernel_scale, config.max_iterations, config.convergence};
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

ScanStatus status_of(const Registration& registration, std::size_t points, bool map_is_empty) {
  if (!registration.map_from_lidar.matrix().allFinite()) return ScanStatus::kDiverged;
  if (points == 0) return ScanStatus::kTooFewPoints;
  if (map_is_empty) return ScanStatus::kInitializing;
  return registration.matches == 0 ? ScanStatus::kTooFewPoints : ScanStatus::kTracked;
}

std::vector<StampedPose> motion_within(const estimation::ScanTimes& times,
                                       const se3::Vector6& twist, const Pose& map_from_lidar,
                                       Time instant, const LidarPath& path) {
  constexpr int kMotionSteps = 4;  // there is one pose more
  if (twist.isZero(0.0)) return {};
  std::vector<StampedPose> poses;
  for (int i = 0; i <= kMotionSteps; ++i) {
    const Time at = times.first + (times.last - times.first) * i / kMotionSteps;
    const Pose pose = map_from_lidar * se3::exp(twist * to_seconds(at - instant));
    poses.push_back({at, path.body_pose(pose)});
  }
  return poses;
}

}  // namespace lidarena::odometry::kiss_icp
