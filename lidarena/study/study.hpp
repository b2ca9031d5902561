// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>

#include "lidarena/base/log.hpp"
#include "lidarena/study/config_folder.hpp"
#include "lidarena/study/study_spec.hpp"

namespace lidarena::study {

struct StudyOptions {
  int threads = 0;  ///< of all jobs together, 0 = one per processor core
  int jobs = 1;     ///< cells that run at the same time, each on its own cores
  Shard shard;
  /// The program lidarena, which does each step; empty = the one beside this process's own program
  /// or in PATH.
  std::filesystem::path program;
  /// Disk space for the measurements of the datasets in use; empty = half of what is free. A
  /// dataset that needs more is simulated anew for each run.
  std::optional<std::uint64_t> scratch_bytes;
};

struct StudyOutcome {
  std::size_t cells = 0;   ///< planned for this shard
  std::size_t runs = 0;    ///< cells with a state: scored, diverged or failed
  std::size_t reused = 0;  ///< found complete in the folder
  std::size_t failed = 0;  ///< crashed, rejected or beyond its limits
  std::size_t diverged = 0;
};

/// Simulates, runs and scores every cell below `out`: datasets/, runs/, study.json and program.json
/// (version of the program and hashes of its code). Each step is a call of the program; what it
/// prints on standard error is added to lidarena.log in the folder of the flight or run. A flight
/// is simulated once; its measurements are deleted when no cell needs them any more. Each folder's
/// request.json holds the keys of the steps that are done in it (version and code of the program,
/// configurations, seed), so a study may be stopped at any time, and the next call continues with
/// what is missing or has changed. A failed cell is recorded with its reason and does not stop the
/// others; the next call tries it again. Throws InputError if another study is running in `out`, or
/// the program is not found.
StudyOutcome run_study(const StudySpec& spec, const ConfigFolder& configs,
                       const std::filesystem::path& out, const StudyOptions& options, LogSink& log);

}  // namespace lidarena::study
