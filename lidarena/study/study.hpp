// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>

#include "lidarena/base/log.hpp"
#include "lidarena/study/config_folder.hpp"
#include "lidarena/study/study_spec.hpp"

namespace lidarena::study {

struct StudyOptions {
  int threads = 0;  ///< of all jobs together, 0 = one per processor core
  int jobs = 1;     ///< cells that run at the same time, each on its own cores
  Shard shard;
};

struct StudyOutcome {
  std::size_t runs = 0;
  std::size_t reused = 0;  ///< found complete in the folder
  std::size_t failed = 0;  ///< crashed, rejected or beyond its limits
  std::size_t diverged = 0;
};

/// Simulates, runs and scores every cell, each in its own process, below `out`: datasets/, runs/
/// and study.json. The last file of every stage is the request that it answers (configurations,
/// seed, checksum of the program); without it, the stage does not count as done. So a study may be
/// stopped at any time, and the next call continues with what is missing. A failed cell is recorded
/// with its reason and does not stop the others; the next call tries it again. Throws InputError if
/// another study is running in `out`. The caller must not have started threads.
StudyOutcome run_study(const StudySpec& spec, const ConfigFolder& configs,
                       const std::filesystem::path& out, const StudyOptions& options, LogSink& log);

}  // namespace lidarena::study
