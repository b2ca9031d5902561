// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "lidarena/base/config_json.hpp"
#include "lidarena/base/log.hpp"
#include "lidarena/base/parallel.hpp"
#include "lidarena/dataset/run_files.hpp"
#include "lidarena/evaluation/map_error.hpp"
#include "lidarena/evaluation/trajectory_error.hpp"
#include "lidarena/world/world.hpp"

namespace lidarena {

/// Version of the document that evaluate_run() writes; raised when a name or a meaning changes.
inline constexpr int kMetricsSchemaVersion = 1;

/// All metrics of one run as metrics.json: association first, then trajectory errors of the live
/// and the final trajectory, then map errors of both maps (null where there is no mesh or no map).
/// `world` may be null. A run that diverged (its manifest says "status": "diverged", or its poses
/// do, see divergence_of()) has a status and a reason, and no errors.
Json evaluate_run(const RunFiles& run, const Trajectory& truth, const World* world,
                  const Parallel& parallel, LogSink& log);

/// One trajectory against the truth: association, the RPE ladder, ATE by gauge, errors over time.
Json evaluate_trajectory(const Trajectory& estimate, const Trajectory& truth);

/// One map (in the estimate's world frame) against the mesh, by gauge.
Json evaluate_map(std::span<const Eigen::Vector3f> map, const Trajectory& estimate,
                  const Trajectory& truth, const World& world, const Parallel& parallel);

/// Why the estimate must not be scored; empty when it may. Laid over the truth by its first pose,
/// it lies farther off than twice the path flown plus 1 m: worse than standing still and worse than
/// flying the right path in any wrong direction.
std::string divergence_of(const Trajectory& estimate, const Trajectory& truth);

}  // namespace lidarena
