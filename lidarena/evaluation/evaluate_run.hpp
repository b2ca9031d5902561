// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "lidarena/base/log.hpp"
#include "lidarena/base/parallel.hpp"
#include "lidarena/dataset/run_files.hpp"
#include "lidarena/evaluation/map/evaluate_map.hpp"
#include "lidarena/evaluation/trajectory/trajectory_error.hpp"
#include "lidarena/results/run_metrics.hpp"
#include "lidarena/world/world.hpp"

namespace lidarena::evaluation {

/// Determines the ground truth of the flight's rays; empty when it is not available.
using Observe = std::function<std::optional<RayTruth>()>;

/// How maps are scored.
struct MapScoring {
  /// Called once. Without it, or if it returns nothing, completeness, signed distance and identity
  /// error are empty.
  Observe observe = {};
  ScoredPoints* scored = nullptr;  ///< if given, gets the distances of the re-projected map
  bool vertices = false;           ///< whether the distance to the mesh's vertices is computed
};

/// All metrics of one run: association first, then trajectory errors of the live and the final
/// trajectory, then map errors of both maps (empty without a mesh or a map). `world` may be null.
/// Of a run that ended itself (its manifest says "status": "diverged") the trajectories until then
/// are scored, no maps; one whose poses diverge (see divergence_of()) has a status and a reason,
/// and no errors. `at_clock`: see evaluate_trajectory().
results::RunMetrics evaluate_run(const dataset::RunFiles& run, const Trajectory& truth,
                                 const world::World* world, const Parallel& parallel, LogSink& log,
                                 const MapScoring& maps = {}, const Trajectory* at_clock = nullptr);

/// Scores one trajectory: association, RPE for each piece length, ATE in each alignment, errors
/// over time. `at_clock`, if given, is the truth with the times that the LiDAR's clock showed.
results::TrajectoryMetrics evaluate_trajectory(const Trajectory& estimate, const Trajectory& truth,
                                               const Trajectory* at_clock = nullptr);

/// Why the estimate must not be scored; empty when it may be. It has diverged when, aligned by its
/// first pose, some position is farther from the truth than twice the path length plus 1 m. That is
/// worse than standing still, and worse than flying the right path in any wrong direction.
std::string divergence_of(const Trajectory& estimate, const Trajectory& truth);

}  // namespace lidarena::evaluation
