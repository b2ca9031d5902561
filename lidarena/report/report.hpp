// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "lidarena/base/log.hpp"
#include "lidarena/base/parallel.hpp"
#include "lidarena/results/expectation.hpp"

namespace lidarena::report {

struct ReportFiles {
  /// report.html, one self-contained file; report.json, its data, if this build has no viewer
  std::filesystem::path page;
  std::filesystem::path csv;                   ///< results.csv, one row per run
  std::vector<results::Judgement> shortfalls;  ///< expectations that fall short
  std::string text_table;                      ///< the main figures, for a terminal
  std::size_t missing = 0;                     ///< planned runs without results
};

/// Writes the page and the tables to the folder `out`, from result files only. Each of `folders` is
/// the folder of a study (plan.json, runs/) or of a part of one, or one RUN folder; several become
/// one report. Maps of runs without clouds are left out. Throws InputError if a folder holds no
/// results.
ReportFiles write_report(const std::vector<std::filesystem::path>& folders,
                         const std::filesystem::path& out, const Parallel& parallel, LogSink& log);

}  // namespace lidarena::report
