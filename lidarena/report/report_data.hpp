// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <vector>

#include "lidarena/report/page_data.hpp"
#include "lidarena/results/run_record.hpp"
#include "lidarena/results/table.hpp"

namespace lidarena::report {

/// What the report's page draws, with `tables`.
/// Folders of runs are relative to `out`. Curves are thinned so that their peaks stay; a study of
/// more than some 5,000 runs has none.
ReportData report_data(const results::StudyResults& results,
                       const std::vector<results::Table>& tables, const std::filesystem::path& out);

}  // namespace lidarena::report
