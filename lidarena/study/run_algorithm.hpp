// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>

#include "lidarena/base/log.hpp"
#include "lidarena/base/parallel.hpp"
#include "lidarena/dataset/dataset.hpp"
#include "lidarena/odometry/factory.hpp"
#include "lidarena/odometry/run.hpp"

namespace lidarena {

/// What `lidarena run` is asked for.
struct RunRequest {
  OdometryRequest odometry;
  std::filesystem::path dataset;
  ReadOptions read;    ///< `read.sensor` names the LiDAR where the dataset has several
  bool paced = false;  ///< drop scans when the algorithm is late, as on a live robot
};

/// A run's summary as its manifest has it.
Json to_json(const RunSummary& summary);
/// What a run's times were taken on and with: processor, cores, memory, version of lidarena.
Json made_on();

/// Runs one algorithm over one dataset and writes the RUN folder `out`, with the re-projected map.
/// Returns the summary; a diverged run is written too, with its reason in the manifest.
RunSummary run_algorithm(const RunRequest& request, const std::filesystem::path& out,
                         const Parallel& parallel, LogSink& log);

/// Scores the RUN folder against the truth and the mesh of the dataset that its manifest names;
/// writes metrics.json, its "resources" apart as resources.json, and scored.ply (map points in the
/// mesh's frame with their distance, at most 400,000 of them, for pictures). Throws InputError when
/// the dataset has no truth.
Json score_run(const std::filesystem::path& run, const Parallel& parallel, LogSink& log);

/// Leaves of a scored RUN folder its record: trajectories, figures, manifest; the maps go.
void remove_maps(const std::filesystem::path& run);

}  // namespace lidarena
