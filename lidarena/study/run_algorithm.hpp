// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>

#include "lidarena/base/log.hpp"
#include "lidarena/base/parallel.hpp"
#include "lidarena/dataset/dataset.hpp"
#include "lidarena/odometry/factory.hpp"
#include "lidarena/odometry/run.hpp"

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

}  // namespace lidarena::study
