// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/odometry/lio_sam/registration.hpp"

#include <array>
#include <optional>

#include "lidarena/estimation/feature_residuals.hpp"

namespace lidarena::odometry::lio_sam {
namespace {

using estimation::FivePoints;
using estimation::PoseEquations;

constexpr float kMaxNeighbor = 1.0F;              // m, maximum distance of the fifth neighbor
constexpr double kMaxPlaneThickness = 0.2;        // m, of a neighbor from the plane of all
constexpr std::size_t kMinMatches = 50;           // fewer do not determine a pose
constexpr double kMinEigenvalue = 100.0;          // of J^T J
constexpr int kSpinningIterations = 30;           // maximum
constexpr int kLivoxIterations = 25;              // maximum in the port
constexpr double kConvergedRotation = 8.7e-4;     // rad, 0.05 degrees
constexpr double kConvergedTranslation = 5.0e-4;  // m

std::optional<estimation::Plane> fit_plane(const FivePoints& points) {
  return estimation::fit_plane(points, estimation::PlaneFit::kUnitOffset, kMaxPlaneThickness);
}

/// Sum over the points whose five neighbors have a shape.
template <class Fit, class Residual>
PoseEquations equations(const std::vector<Eigen::Vector3f>& points, const map::KdTree& tree,
                        const Pose& pose, const Parallel& parallel, Fit&& fit,
                        Residual&& residual) {
  return estimation::accumulate_normal_equations<6>(
      parallel, points.size(), [&](std::size_t i, PoseEquations& sum) {
        const Eigen::Vector3d point = points[i].cast<double>();
        std::array<map::Neighbor, 5> near;
        if (tree.nearest((pose * point).cast<float>(), near, kMaxNeighbor) < near.size()) return;
        const auto shape = fit(map::columns_of(near));
        if (!shape) return;
        if (const auto distance = residual(point, *shape, pose)) distance->add_to(sum);
      });
}

}  // namespace

Registration register_features(const Features& features, const FeatureMap& map, const Pose& guess,
                               Sensor sensor, const Parallel& parallel) {
  const int max_iterations = sensor == Sensor::kLivox ? kLivoxIterations : kSpinningIterations;
  Registration result{.map_from_lidar = guess};
  estimation::Degenerate degenerate;
  while (result.iterations < max_iterations && !result.converged) {
    PoseEquations sum = equations(features.edges, map.edges(), result.map_from_lidar, parallel,
                                  estimation::fit_line, estimation::edge_residual);
    sum += equations(features.surfaces, map.surfaces(), result.map_from_lidar, parallel, fit_plane,
                     estimation::surface_residual);
    if (sum.count < kMinMatches) break;
    if (result.iterations == 0)
      degenerate =
          estimation::find_degenerate(sum.hessian, PoseEquations::Vector::Ones(), kMinEigenvalue);
    const PoseEquations::Vector step = degenerate.observed * sum.solve();
    result.map_from_lidar = estimation::moved(result.map_from_lidar, step);
    result.matches = sum.count;
    result.converged =
        step.head<3>().norm() < kConvergedRotation && step.tail<3>().norm() < kConvergedTranslation;
    ++result.iterations;
  }
  result.degenerate_directions = degenerate.directions;
  result.map_from_lidar = orthonormalized(result.map_from_lidar);
  return result;
}

}  // namespace lidarena::odometry::lio_sam
