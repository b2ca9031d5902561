// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>

#include "lidarena/base/log.hpp"
#include "lidarena/base/parallel.hpp"
#include "lidarena/dataset/dataset.hpp"
#include "lidarena/odometry/factory.hpp"
#include "lidarena/odometry/run.hpp"
#include "lidarena/results/run_metrics.hpp"

namespace lidarena::study {

/// Input of `lidarena run`.
struct RunRequest {
  odometry::OdometryRequest odometry;
  std::filesystem::path dataset;
  dataset::ReadOptions read;  ///< `read.sensor` names the LiDAR if the dataset has several
  bool paced = false;         ///< drop scans when the algorithm is late, as on a live robot
};

/// A run's summary as written to its manifest.
Json summary_json(const odometry::RunSummary& summary);
/// Where a run's times were measured: processor, cores, memory, version of lidarena.
Json made_on();

/// Runs one algorithm over one dataset and writes the RUN folder `out`, with the re-projected map.
/// Returns the summary; a diverged run is written too, with its reason in the manifest.
odometry::RunSummary run_algorithm(const RunRequest& request, const std::filesystem::path& out,
                                   const Parallel& parallel, LogSink& log);

/// Scores the RUN folder against the truth and the mesh of the dataset that its manifest names.
/// Writes metrics.json, resources.json and scored.ply (at most 400,000 map points in the mesh's
/// frame with their distance, for pictures). Throws InputError if the dataset has no truth.
results::RunMetrics score_run(const std::filesystem::path& run, const Parallel& parallel,
                              LogSink& log);

/// Deletes the maps of a scored RUN folder; trajectories, metrics and manifest stay.
void remove_maps(const std::filesystem::path& run);

}  // namespace lidarena::study
