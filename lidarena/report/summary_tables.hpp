// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "lidarena/report/table.hpp"
#include "lidarena/results/run_record.hpp"

namespace lidarena::report {

/// The best algorithm for each world and sensor by drift, and by outliers of the map.
ReportTable winners_table(const results::StudyResults& results);
/// All runs of a world with all their figures; failed runs are rows, too.
ReportTable runs_table(const results::StudyResults& results, const std::string& world);
/// Runs that failed, diverged or were not scored, with their reasons.
ReportTable failures_table(const results::StudyResults& results);
/// The commands that reproduce each run, including its dataset.
ReportTable commands_table(const results::StudyResults& results);
/// The study's expectations, judged by the runs of one variant: "holds", "falls short", "cannot be
/// judged" or "not measured", with the figures.
ReportTable expectations_table(const results::StudyResults& results, const std::string& variant);

}  // namespace lidarena::report
