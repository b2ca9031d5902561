// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "lidarena/base/log.hpp"
#include "lidarena/base/parallel.hpp"
#include "lidarena/dataset/dataset.hpp"
#include "lidarena/dataset/run_manifest.hpp"
#include "lidarena/odometry/factory.hpp"
#include "lidarena/odometry/run.hpp"

namespace lidarena::stages {

/// Input of `lidarena run`.
struct RunRequest {
  odometry::OdometryRequest odometry;
  std::filesystem::path dataset;
  dataset::ReadOptions read;      ///< `read.sensor` names the LiDAR if the dataset has several
  std::vector<std::string> also;  ///< further LiDARs whose points are added to its scans
  bool paced = false;             ///< drop scans when the algorithm is late, as on a live robot
  int parts = 0;                  ///< of each sweep, see SplitSweeps; 0: as the preset has it
  bool maps = true;               ///< write map.ply and reprojected.ply
};

/// The part of a run's manifest that does not depend on how the run was made: status, counts, the
/// machine, and the LiDAR. `out`: the RUN folder, from which the dataset's path is given.
dataset::RunManifest manifest_of(const odometry::RunSummary& summary, const LidarInfo& lidar,
                                 const std::filesystem::path& dataset,
                                 const std::filesystem::path& out, const Parallel& parallel);
/// The same of a method of ours.
dataset::RunManifest manifest_of(const odometry::OdometryRequest& request, const Json& config,
                                 const odometry::OdometryTraits& traits,
                                 dataset::RunManifest manifest);

/// Runs one algorithm over one dataset and writes the RUN folder `out`, with the re-projected map.
/// Returns the summary; a diverged run is written too, with its reason in the manifest.
odometry::RunSummary run_algorithm(const RunRequest& request, const std::filesystem::path& out,
                                   const Parallel& parallel, LogSink& log);

}  // namespace lidarena::stages
