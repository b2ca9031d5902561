// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "lidarena/base/parallel.hpp"
#include "lidarena/dataset/points/cloud.hpp"
#include "lidarena/dataset/run_events.hpp"
#include "lidarena/dataset/run_manifest.hpp"
#include "lidarena/evaluation/map/return_store.hpp"
#include "lidarena/stages/event_record.hpp"
#include "lidarena/stages/external_program.hpp"
#include "lidarena/stages/process.hpp"
#include "lidarena/stages/run_algorithm.hpp"

/// What running a program that is not part of lidarena consists of, whether it reads files or live
/// topics: what it is given, and how a RUN folder is made of what it leaves.
namespace lidarena::stages {

/// Files in a RUN folder: what the program printed, what it is given, what it leaves.
inline constexpr const char* kProgramLog = "program.log";
inline constexpr const char* kProgramInput = "input";
inline constexpr const char* kProgramOutput = "output";

/// One LiDAR of a rig and the IMU beside it. `id` may be empty if there is only one LiDAR. Throws
/// InputError (place `place`) for a LiDAR that the rig lacks.
Rig rig_of_one(const Rig& rig, const std::string& id, const std::string& place);

/// First firing and last point of a scan.
struct ScanSpan {
  Time stamp, end;
};

/// Poses as the program wrote them, at the times of the flight: program.start_s is subtracted, and
/// a stamp that is a scan's, within 1 ms, becomes the instant that program.pose_at names. `spans`
/// are those of the scans, in the order of time.
Trajectory at_flight_times(const ExternalProgram& program, const Trajectory& poses,
                           const std::vector<ScanSpan>& spans);

/// A recording of one LiDAR of a dataset and its IMU, without the truth.
struct ProgramInput {
  Rig rig;
  std::size_t scans = 0;
  double seconds = 0.0;  ///< stamp of the last scan
  std::filesystem::path path;
  std::filesystem::path rig_file;  ///< JSON of `rig`
  std::vector<ScanSpan> spans;     ///< at the times of the flight
  EventRecord events;              ///< of the IMU
  std::optional<Time> first_scan;
  std::unique_ptr<evaluation::ReturnStore> returns;  ///< those that are scored
};

/// `command` with each `key` replaced by `value`.
std::string substitute(std::string command, const std::string& key, const std::string& value);

/// Records to `folder` what the program is given, in its format and dialect, and keeps the scored
/// returns on the disk of `folder`.
ProgramInput record_for(const ExternalProgram& program, const RunRequest& request,
                        const std::filesystem::path& folder, const Parallel& parallel);

/// The program's command with {input}, {output}, {sensor}, {threads} and {rig} replaced.
std::string command_line(const ExternalProgram& program, const ProgramInput& recording,
                         const std::filesystem::path& output, const Parallel& parallel);

/// /bin/sh with that command, in this process's group; its output goes to `log`, anew.
Command shell_command(const std::string& command, const std::filesystem::path& log);

/// What a program left.
struct ForeignRun {
  std::string name;
  PoseOf pose_of = PoseOf::kLidar;
  /// Poses of the frame `pose_of` in the program's world: the final ones, those known at each scan
  /// (empty: the same), and the motion within the scans (empty: not known).
  Trajectory trajectory, live, motion;
  dataset::Cloud map;  ///< in the same world
  std::optional<std::vector<dataset::RunEvent>> events;
  odometry::RunSummary summary;
  std::string preset;  ///< for the manifest, as all that follows
  Json config;
  bool on_live_topics = false;
  std::optional<dataset::ProcessUse> process;
  Json messages;
};

/// The scored returns of the LiDAR of a dataset, which is read for them.
std::unique_ptr<evaluation::ReturnStore> returns_of(const RunRequest& request, const Rig& rig,
                                                    const std::filesystem::path& folder,
                                                    const Parallel& parallel);

/// Writes the RUN folder `out`: poses of the body, the scored returns placed by them, the program's
/// own map. `rig` is that of rig_of_one().
void write_foreign_run(const ForeignRun& run, const Rig& rig,
                       const evaluation::ReturnStore& returns, const RunRequest& request,
                       const std::filesystem::path& out, const Parallel& parallel);

}  // namespace lidarena::stages
