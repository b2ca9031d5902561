// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <vector>

#include "lidarena/base/config_json.hpp"
#include "lidarena/results/run_record.hpp"
#include "lidarena/results/table.hpp"

namespace lidarena::report {

/// What the report's page draws, as viewer/src/report/data.ts describes it: the figures and curves
/// of each run, the sensors, the decision, which claims a test supports, published figures,
/// and `tables`.
/// Folders of runs are relative to `out`. Curves are thinned so that their peaks stay; a study of
/// more than some 5,000 runs has none.
Json report_data(const results::StudyResults& results, const std::vector<results::Table>& tables,
                 const std::filesystem::path& out);

}  // namespace lidarena::report
