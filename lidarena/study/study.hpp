// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>

#include "lidarena/base/log.hpp"
#include "lidarena/stages/config_folder.hpp"
#include "lidarena/study/plan.hpp"
#include "lidarena/study/study_spec.hpp"

namespace lidarena::study {

/// Whether a study is to end early: not before the runs in progress have ended or the time of grace
/// is over, or at once.
enum class Stop { kNo, kSoon, kNow };

struct StudyOptions {
  int threads = 0;  ///< of all jobs together, 0 = one per processor core
  int jobs = 1;     ///< cells that run at the same time, each on its own cores
  Shard shard;
  /// The program lidarena, which does each step; empty = the one beside this process's own program
  /// or in PATH.
  std::filesystem::path program;
  /// Folder for flights and runs in progress, on any disk; empty = in the study's folder.
  std::filesystem::path scratch;
  /// Disk space for the measurements of the datasets in use; empty = half of what is free. A
  /// dataset that needs more is simulated anew for each run.
  std::optional<std::uint64_t> scratch_bytes;
  /// results.csv files of earlier parts of this study, see take_known_rows().
  std::vector<std::filesystem::path> known;
  std::function<Stop()> stop;  ///< asked often; empty = never
  double grace_s = 0.0;        ///< after Stop::kSoon
  /// Stay until other processes have finished their units, to take over those of dead ones.
  bool waits_for_others = true;
};

struct StudyOutcome {
  std::size_t cells = 0;   ///< planned for this shard
  std::size_t runs = 0;    ///< cells with a state: scored, diverged or failed
  std::size_t reused = 0;  ///< of these, not run by this call
  std::size_t failed = 0;  ///< crashed, rejected or beyond its limits
  std::size_t diverged = 0;
  bool is_interrupted = false;  ///< ended by StudyOptions::stop, with work left
  bool has_advanced = false;    ///< this call has finished a flight or a run
};

/// Plans the study in the folder `out`: writes plan.json. Cells that failed in an earlier call will
/// be run again. Throws InputError if another study is running in `out`, or the folder was planned
/// for another number of shards.
StudyPlan plan_study(const StudySpec& spec, const stages::ConfigFolder& configs,
                     const std::filesystem::path& out, const StudyOptions& options);

/// Does what is missing in a planned study, together with any other process that works in the same
/// folder: each takes a unit (a dataset with its cells) that nobody has. Each step is a call of the
/// program; what it prints on standard error is added to lidarena.log in the folder of the flight
/// or run. A flight is simulated once for the cells of its unit. Each folder's request.json holds
/// the keys of the steps that are done in it (version and code of the program, configurations,
/// seed), so that a study may be stopped at any time, and the next call continues with what is
/// missing or has changed. A failed cell is recorded with its reason and does not stop the others.
/// Throws InputError if the folder holds no plan, or the program or a configuration file is not the
/// one that was planned with; Error if a disk is full.
StudyOutcome work_on_study(const std::filesystem::path& out, const stages::ConfigFolder& configs,
                           const StudyOptions& options, LogSink& log);

/// Plans the study and does all of it.
StudyOutcome run_study(const StudySpec& spec, const stages::ConfigFolder& configs,
                       const std::filesystem::path& out, const StudyOptions& options, LogSink& log);

/// Half of the disk space that is free below `folder`, bytes.
std::uint64_t default_scratch_bytes(const std::filesystem::path& folder);

}  // namespace lidarena::study
