// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/odometry/arena_lo/registration.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "lidarena/estimation/robust_kernel.hpp"

namespace lidarena::odometry::arena_lo {
namespace {

constexpr std::size_t kGrain = 128;     // points per task
constexpr double kNarrowing = 0.5;      // of the kernel, from one pass to the next
constexpr double kMaxScale = 3.0;       // m, of the kernel in the second pass
constexpr int kSingleSlicePasses = 10;  // as many times the passes of others, at most
constexpr double kCut = 4.0;            // scales of the kernel; points beyond have no weight
constexpr double kConvergence = 2e-4;   // m and rad: largest change by a pass that ends a search

/// Standard deviation (m) of the position of a point of the body, the mean of all directions.
double deviation(const estimation::MotionMatrix& covariance, const Eigen::Vector3d& arm) {
  const double of_position = covariance.block<3, 3>(0, 0).trace();
  const double of_rotation = covariance.block<3, 3>(3, 3).trace();
  return std::sqrt((of_position + of_rotation * arm.squaredNorm()) / 3.0);
}

/// Adds a point (m, lidar frame) to the sums of measure().
void add(const Eigen::Vector3f& point, const estimation::MotionEstimate& at, double least_scale,
         const map::LocalPlanes& map, const Config& config, Measurement& sum) {
  const Eigen::Vector3d arm = point.cast<double>();
  const Eigen::Vector3d position = at.state.pose * arm;
  const double scale = std::max(least_scale, deviation(at.covariance, arm));
  ++sum.points;
  sum.sum_of_scales += scale;
  // A place that is uncertain by more than a cell has fine planes of elsewhere.
  const map::MapPlane* plane =
      map.plane_at(position.cast<float>(), at.state.pose.translation().cast<float>(),
                   scale > config.map.cell_size_m);
  if (plane == nullptr) return;
  ++sum.near_planes;
  const Eigen::Vector3d normal = plane->normal.cast<double>();
  const double distance = normal.dot(position - plane->center.cast<double>());
  if (std::abs(distance) > kCut * scale) return;
  if (std::abs(distance) < config.kernel_scale_m) ++sum.on_planes;
  Eigen::Matrix<double, 1, 6> row;
  row << normal.transpose(), arm.cross(at.state.pose.linear().transpose() * normal).transpose();
  const double widened = scale / config.kernel_scale_m;
  const double variance =
      std::max(config.point_variance_m2 * widened * widened, static_cast<double>(plane->variance));
  sum.equations.add<1>(row, Eigen::Matrix<double, 1, 1>(distance),
                       estimation::geman_mcclure_weight(distance, scale) / variance);
}

/// Largest change (m, rad) of a pose from one pass to the next.
double change_between(const Motion& a, const Motion& b) {
  double largest = 0.0;
  for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i) {
    const estimation::MotionVector change = b[i].state - a[i].state;
    largest = std::max(largest, change.head<6>().cwiseAbs().maxCoeff());
  }
  return largest;
}

/// One filtering pass: steps at the slices' middles, updated by what `measured` says of slice i,
/// for which it is given the prediction, and where it linearized it; and a last step at `end`.
template <class Measured>
Steps filtered(const Known& before, std::span<const Slice> slices, Time end, const Config& config,
               Measured&& measured) {
  const estimation::ManeuverModel model{config.acceleration_m_s2, config.acceleration_time_s,
                                        config.angular_acceleration_rad_s2,
                                        config.angular_acceleration_time_s};
  Steps steps;
  steps.reserve(slices.size() + 1);
  Known known = before;
  const auto go_to = [&](Time instant) {
    const double seconds = to_seconds(instant - known.instant);
    const auto prediction = estimation::predicted(known.estimate, seconds, model);
    known = {prediction.estimate, instant};
    steps.push_back({prediction, prediction.estimate});
  };
  for (std::size_t i = 0; i < slices.size(); ++i) {
    go_to(slices[i].middle);
    known.estimate = measured(i, known.estimate);
    steps.back().estimate = known.estimate;
  }
  go_to(end);
  return steps;
}

}  // namespace

Measurement& Measurement::operator+=(const Measurement& other) {
  equations += other.equations;
  points += other.points;
  sum_of_scales += other.sum_of_scales;
  near_planes += other.near_planes;
  on_planes += other.on_planes;
  return *this;
}

Measurement measure(std::span<const Eigen::Vector3f> points, const estimation::MotionEstimate& at,
                    double least_scale, const map::LocalPlanes& map, const Config& config,
                    const Parallel& parallel) {
  return parallel.reduce(
      points.size(), kGrain, Measurement{},
      [&](std::size_t begin, std::size_t end) {
        Measurement part;
        for (std::size_t i = begin; i < end; ++i)
          add(points[i], at, least_scale, map, config, part);
        return part;
      },
      [](Measurement& total, const Measurement& part) { total += part; });
}

Steps coast(const Known& before, std::span<const Slice> slices, Time end, const Config& config) {
  return filtered(before, slices, end, config,
                  [](std::size_t, const estimation::MotionEstimate& prior) { return prior; });
}

Registration register_slices(const Known& before, std::span<const Slice> slices, Time end,
                             const map::LocalPlanes& map, const Config& config,
                             const Parallel& parallel) {
  const int most = std::max(1, config.max_scan_points / static_cast<int>(slices.size()));
  std::vector<std::vector<Eigen::Vector3f>> points(slices.size());
  Registration found;
  double scale = std::max(config.first_kernel_scale_m, config.kernel_scale_m);
  // A single slice has no others that predict it, so it starts farther away.
  const int passes = slices.size() > 1 ? config.max_passes : kSingleSlicePasses * config.max_passes;
  for (int narrow = 0; narrow < passes; ++found.passes) {
    Measurement whole;
    const auto measured = [&](std::size_t i, const estimation::MotionEstimate& prior) {
      const estimation::MotionEstimate& at = found.passes == 0 ? prior : found.motion[i];
      if (found.passes < 2) points[i] = averages(slices[i], at.state, most, config, parallel);
      const Measurement part = measure(points[i], at, scale, map, config, parallel);
      whole += part;
      return estimation::updated(prior, at.state, part.equations);
    };
    found.steps = filtered(before, slices, end, config, measured);
    Motion motion = estimation::smoothed(found.steps);
    const double change = change_between(found.motion, motion);
    found.motion = std::move(motion);
    found.measurement = whole;
    if (scale <= config.kernel_scale_m) ++narrow;
    if (narrow > 1 && change < kConvergence) narrow = passes;
    if (found.passes == 0 && whole.points > 0)  // the kernels of uncertain points are wider
      scale = std::min(whole.sum_of_scales / static_cast<double>(whole.points), kMaxScale);
    scale = std::max(kNarrowing * scale, config.kernel_scale_m);
  }
  for (std::size_t i = 0; i < slices.size(); ++i) {
    const Pose& map_from_lidar = found.motion[i].state.pose;
    const Eigen::Vector3f sensor = map_from_lidar.translation().cast<float>();
    const std::vector<Contact> part =
        contacts_of(transformed(map_from_lidar, points[i]), sensor, map, config.kernel_scale_m);
    found.contacts.insert(found.contacts.end(), part.begin(), part.end());
  }
  return found;
}

}  // namespace lidarena::odometry::arena_lo
