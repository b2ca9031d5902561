// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "lidarena/base/log.hpp"

namespace lidarena {

struct ReportFiles {
  std::filesystem::path page;  ///< report.html, one self-contained file
  std::filesystem::path csv;   ///< results.csv, a row a run
  std::string text_table;      ///< the main figures, for a terminal
};

/// Makes the page and the tables from result files alone, into the folder `out`. Each of `folders`
/// is a study's (study.json, runs/), or a part of one made elsewhere, or one RUN folder; several
/// become one report. Runs may have lost their clouds: their pictures are left out. Throws
/// InputError when a folder holds no results.
ReportFiles write_report(const std::vector<std::filesystem::path>& folders,
                         const std::filesystem::path& out, LogSink& log);

}  // namespace lidarena
