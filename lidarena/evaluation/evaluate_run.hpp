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

/// All metrics of one run as metrics.json: association first, then trajectory errors of the live
/// and the final trajectory, then map errors of both maps (null where there is no mesh).
/// `world` may be null.
Json evaluate_run(const RunFiles& run, const Trajectory& truth, const World* world,
                  const Parallel& parallel, LogSink& log);

}  // namespace lidarena
