// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/odometry/lio_sam/registration.hpp"

#include "lidarena/odometry/lio_sam/feature_matching.hpp"

namespace lidarena::odometry::lio_sam {
namespace {

using estimation::PoseEquations;

constexpr std::size_t kMinMatches = 50;           // fewer do not determine a pose
constexpr double kMinEigenvalue = 100.0;          // of J^T J
constexpr int kSpinningIterations = 30;           // maximum
constexpr int kLivoxIterations = 25;              // maximum in the port
constexpr double kConvergedRotation = 8.7e-4;     // rad, 0.05 degrees
constexpr double kConvergedTranslation = 5.0e-4;  // m

}  // namespace

Registration register_features(const map::Features& features, const map::FeatureMap& map,
                               const Pose& guess, Sensor sensor, const Parallel& parallel) {
  const int max_iterations = sensor == Sensor::kLivox ? kLivoxIterations : kSpinningIterations;
  Registration result{.map_from_lidar = guess};
  estimation::Degenerate degenerate;
  while (result.iterations < max_iterations && !result.converged) {
    const PoseEquations sum = match_features(features, map, result.map_from_lidar, parallel);
    if (sum.count < kMinMatches) break;
    if (result.iterations == 0)
      degenerate = estimation::find_degenerate(sum.hessian, kMinEigenvalue);
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
