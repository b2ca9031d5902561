// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>

#include "lidarena/base/log.hpp"

namespace lidarena {

struct ReportFiles {
  std::filesystem::path page;  ///< report.html, one self-contained file
  std::filesystem::path csv;   ///< results.csv, a row a run
  std::string text_table;      ///< the main figures, for a terminal
};

/// Makes the page and the table from result files alone: a study's folder (study.json, runs/), or
/// one RUN folder. Throws InputError when the folder holds no results.
ReportFiles write_report(const std::filesystem::path& folder, LogSink& log);

}  // namespace lidarena
