// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "lidarena/base/config_json.hpp"
#include "lidarena/base/log.hpp"
#include "lidarena/base/parallel.hpp"
#include "lidarena/dataset/run_files.hpp"
#include "lidarena/evaluation/evaluate_map.hpp"
#include "lidarena/evaluation/trajectory_error.hpp"
#include "lidarena/world/world.hpp"

namespace lidarena {

/// Version of the document that evaluate_run() writes; raised when a name or a meaning changes.
inline constexpr int kMetricsSchemaVersion = 2;

/// Finds out what the flight's rays saw; nothing where that cannot be known.
using Observe = std::function<std::optional<RayTruth>()>;

/// All metrics of one run as metrics.json: association first, then trajectory errors of the live
/// and the final trajectory, then map errors of both maps (null where there is no mesh or no map).
/// `world` may be null. A run that diverged (its manifest says "status": "diverged", or its poses
/// do, see divergence_of()) has a status and a reason, and no errors. `observe`, if given, is asked
/// once when maps are scored; without it (or when it has none) there is no completeness and no
/// signed distance, nor an identity error.
Json evaluate_run(const RunFiles& run, const Trajectory& truth, const World* world,
                  const Parallel& parallel, LogSink& log, const Observe& observe = {});

/// One trajectory against the truth: association, the RPE ladder, ATE by gauge, errors over time.
Json evaluate_trajectory(const Trajectory& estimate, const Trajectory& truth);

/// Why the estimate must not be scored; empty when it may. Laid over the truth by its first pose,
/// it lies farther off than twice the path flown plus 1 m: worse than standing still and worse than
/// flying the right path in any wrong direction.
std::string divergence_of(const Trajectory& estimate, const Trajectory& truth);

}  // namespace lidarena
