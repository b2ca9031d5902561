// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "lidarena/report/table.hpp"
#include "lidarena/results/run_record.hpp"

namespace lidarena::report {

/// For a study that simulates the same flights in several timing modes: drift, map RMSE and outlier
/// share of every sensor and algorithm, one column per mode, for each world and preset. Empty if
/// there are fewer than two modes.
std::vector<ReportTable> timing_tables(const results::StudyResults& results);

}  // namespace lidarena::report
