// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/stages/run_external.hpp"

#include <fmt/format.h>

#include <chrono>

#include "lidarena/dataset/trajectories/trajectory_io.hpp"

namespace lidarena::stages {
namespace {

namespace fs = std::filesystem;

/// Runs the command line until it ends; its output goes to `log`.
ProcessEnd run_command(const std::string& name, const std::string& command, const fs::path& log) {
  ProcessEnd end = Process(shell_command(command, log)).wait();
  if (end.exit_code != 0) {
    throw Error(
        fmt::format("{} ended with {}; its output is in {}", name,
                    end.exit_code < 0 ? end.reason : fmt::format("exit code {}", end.exit_code),
                    log.filename().string()));
  }
  return end;
}

dataset::Cloud map_of(const fs::path& output) {
  for (const char* name : {"map.ply", "map.pcd"}) {
    if (fs::exists(output / name)) return dataset::read_cloud(output / name);
  }
  return {};
}

}  // namespace

odometry::RunSummary run_external(const ExternalProgram& program, const RunRequest& request,
                                  const fs::path& out, const Parallel& parallel, LogSink& log) {
  if (program.node.is_used()) {
    throw InputError(program.name, "is driven through live topics",
                     "run it by the program: lidarena run NAME DATASET --external FILE");
  }
  const fs::path input = out / kProgramInput, output = out / kProgramOutput;
  for (const fs::path& stale : {input, output}) fs::remove_all(stale);
  fs::create_directories(output);
  log.info("recording for " + program.name);
  const ProgramInput recording = record_for(program, request, input, parallel);
  log.info("running " + program.name);
  const auto begin = std::chrono::steady_clock::now();
  const ProcessEnd used = run_command(
      program.name, command_line(program, recording, output, parallel), out / kProgramLog);
  const std::chrono::duration<double> wall = std::chrono::steady_clock::now() - begin;
  fs::remove_all(input);

  const fs::path left = output / "trajectory.tum";
  if (!fs::exists(left)) {
    throw InputError(program.name, "left no trajectory.tum in {output}",
                     "see docs/external_slam.md; its output is in program.log");
  }
  ForeignRun run;
  run.name = program.name;
  run.pose_of = program.pose_of;
  run.trajectory = at_flight_times(program, dataset::read_trajectory(left), recording.spans);
  if (const fs::path motion = output / "motion.tum"; fs::exists(motion))
    run.motion = at_flight_times(program, dataset::read_trajectory(motion), recording.spans);
  run.map = map_of(output);
  run.events = recording.events.events(recording.first_scan.value_or(Time{0}));
  run.summary.scans = recording.scans;
  run.summary.sensor_seconds = recording.seconds;
  run.summary.compute_seconds = wall.count();
  run.preset = "external";
  run.config = to_json(program);
  run.process = {used.processor_s, used.peak_mb};
  write_foreign_run(run, recording.rig, *recording.returns, request, out, parallel);
  fs::remove_all(output);
  return run.summary;
}

}  // namespace lidarena::stages
