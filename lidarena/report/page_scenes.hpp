// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "lidarena/base/log.hpp"
#include "lidarena/base/parallel.hpp"
#include "lidarena/report/scene_blocks.hpp"
#include "lidarena/results/run_record.hpp"

namespace lidarena::report {

/// For each world of a study whose folders still hold points, the scene that the report's page
/// draws: one map and path for each flight, sensor and method, which bear the run's name; the mesh;
/// one scan of each sensor, de-skewed by the true motion ("scan SENSOR") and as measured ("skewed
/// SENSOR"). Sizes keep a study of some 30 runs below 12 MB and any study below 60 MB.
std::vector<PackedScene> page_scenes(const results::StudyResults& results, const Parallel& parallel,
                                     LogSink& log);

}  // namespace lidarena::report
