// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>

#include "lidarena/base/log.hpp"
#include "lidarena/base/parallel.hpp"
#include "lidarena/study/run_algorithm.hpp"
#include "lidarena/study/study_spec.hpp"

namespace lidarena {

/// File of a run with what the external program printed.
inline constexpr const char* kProgramLog = "program.log";

/// Lets a program of someone else's run over the dataset that `request` names, and writes the RUN
/// folder `out` from what it leaves, so that it can be scored like an algorithm of ours. The
/// program gets a recording of the one LiDAR and the IMU beside it, without the truth, and its
/// command line with {input} (the recording: a file, or a folder of sweeps), {output} (an empty
/// folder), {sensor} (the LiDAR's id) and {threads} replaced. It must leave trajectory.tum in
/// {output}, poses of what `program.pose_of` says at the scans' stamps or as often as it likes, and
/// may leave map.ply or map.pcd. What it prints goes to program.log. Throws Error when it ends
/// otherwise than with exit code 0, InputError when what it left cannot be read.
RunSummary run_external(const ExternalProgram& program, const RunRequest& request,
                        const std::filesystem::path& out, const Parallel& parallel, LogSink& log);

}  // namespace lidarena
