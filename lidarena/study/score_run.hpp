// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>

#include "lidarena/base/log.hpp"
#include "lidarena/base/parallel.hpp"
#include "lidarena/results/run_metrics.hpp"

namespace lidarena::study {

/// Scores the RUN folder against the truth and the mesh of the dataset that its manifest names.
/// Writes metrics.json, resources.json and scored.ply (at most 400,000 map points in the mesh's
/// frame with their distance, for pictures). Throws InputError if the dataset has no truth.
results::RunMetrics score_run(const std::filesystem::path& run, const Parallel& parallel,
                              LogSink& log);

/// Deletes the maps of a scored RUN folder and the motion that they were made with; trajectories,
/// metrics and manifest stay.
void remove_maps(const std::filesystem::path& run);

}  // namespace lidarena::study
