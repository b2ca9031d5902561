// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>

#include "lidarena/base/log.hpp"
#include "lidarena/base/parallel.hpp"
#include "lidarena/stages/external_program.hpp"
#include "lidarena/stages/foreign_program.hpp"
#include "lidarena/stages/run_algorithm.hpp"

namespace lidarena::stages {

/// Runs an external program over the dataset that `request` names and writes the RUN folder `out`
/// from its results, so that it can be scored like a built-in algorithm. The program gets a
/// recording of the chosen LiDAR and the IMU beside it, without the truth. In its command line,
/// {input} (the recording: a file, or a folder of sweeps), {output} (an empty folder), {sensor}
/// (the LiDAR's id), {threads} and {rig} (a JSON file of LiDAR and IMU) are replaced. It must write
/// trajectory.tum to {output}: poses of the frame `program.pose_of`, at the scans' stamps or any
/// others. It may write map.ply or map.pcd. What it prints goes to program.log. Throws Error if its
/// exit code is not 0, InputError if its files cannot be read, or for a program with a `node` (see
/// `lidarena run`).
odometry::RunSummary run_external(const ExternalProgram& program, const RunRequest& request,
                                  const std::filesystem::path& out, const Parallel& parallel,
                                  LogSink& log);

}  // namespace lidarena::stages
