// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/odometry/arena_slam/registration.hpp"

#include <cmath>

#include "lidarena/odometry/feature_matcher.hpp"

namespace lidarena::odometry::arena_slam {
namespace {

using estimation::PoseEquations;

constexpr double kConvergedRotation = 2e-4;     // rad: converged below this step
constexpr double kConvergedTranslation = 2e-4;  // m: likewise
constexpr double kReassociation = 0.01;         // m: after a smaller step matches are kept
constexpr double kMinPlaneRatio = 0.05;  // minimum spread of a plane's narrow side / wide side
constexpr std::size_t kMinMatches = 50;  // fewer do not determine a pose
constexpr double kMinShare = 0.003;      // minimum share of a direction; isotropic: 1/6

/// Root mean square of the points' ranges.
double lever_of(const std::vector<Eigen::Vector3f>& points) {
  double sum = 0.0;
  for (const Eigen::Vector3f& p : points) sum += static_cast<double>(p.squaredNorm());
  return points.empty() ? 1.0 : std::sqrt(sum / static_cast<double>(points.size()));
}

}  // namespace

estimation::Degenerate find_degenerate(const PoseEquations& points, double lever) {
  PoseEquations::Vector unit = PoseEquations::Vector::Ones();
  unit.head<3>().setConstant(1.0 / lever);
  return estimation::find_degenerate(points.hessian, unit,
                                     kMinShare * static_cast<double>(points.count));
}

Registration register_features(const map::Features& features, const map::FeatureMap& map,
                               const Pose& guess, const RegistrationLimits& limits,
                               const Parallel& parallel) {
  Registration result;
  result.map_from_lidar = guess;
  FeatureMatcher matcher(
      features, map,
      {estimation::PlaneFit::kPrincipal, limits.max_plane_thickness_m, kMinPlaneRatio}, parallel);
  estimation::Degenerate degenerate;
  const double lever = lever_of(features.surfaces);
  double step_size = 1.0;
  while (result.iterations < limits.max_iterations && !result.converged) {
    const PoseEquations points =
        matcher.equations(result.map_from_lidar, step_size > kReassociation);
    if (points.count < kMinMatches) break;
    if (result.iterations == 0) degenerate = find_degenerate(points, lever);
    const PoseEquations::Vector step = degenerate.observed * points.solve();
    result.map_from_lidar = estimation::moved(result.map_from_lidar, step);
    result.points = points;
    result.degenerate_directions = degenerate.directions;
    step_size = step.tail<3>().norm() + lever * step.head<3>().norm();
    result.converged =
        step.head<3>().norm() < kConvergedRotation && step.tail<3>().norm() < kConvergedTranslation;
    ++result.iterations;
  }
  result.map_from_lidar = orthonormalized(result.map_from_lidar);
  return result;
}

}  // namespace lidarena::odometry::arena_slam
