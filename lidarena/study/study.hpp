// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>

#include "lidarena/base/log.hpp"
#include "lidarena/study/config_folder.hpp"
#include "lidarena/study/study_spec.hpp"

namespace lidarena {

struct StudyOptions {
  int threads = 0;  ///< of all jobs together, 0 = one a processor core
  int jobs = 1;     ///< cells at work at the same time, each on cores of its own
  Shard shard;
};

struct StudyOutcome {
  std::size_t runs = 0;
  std::size_t reused = 0;  ///< found complete in the folder
  std::size_t failed = 0;  ///< crashed, refused or beyond its limits
  std::size_t diverged = 0;
};

/// Flies, runs and scores every cell, each in a process of its own, below `out`: datasets/, runs/
/// and study.json. Every stage lies beside the request that it answers (configurations, seed, the
/// program itself) and counts as done only once that is written, last; so the study may be stopped
/// at any moment, and the next call goes on with what is missing. A failed cell is recorded with
/// its reason and does not stop the others; the next call tries it again. Throws InputError when
/// another study is at work in `out`. The caller must not have started threads.
StudyOutcome run_study(const StudySpec& spec, const ConfigFolder& configs,
                       const std::filesystem::path& out, const StudyOptions& options, LogSink& log);

}  // namespace lidarena
