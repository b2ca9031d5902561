// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "lidarena/report/result_table.hpp"
#include "lidarena/report/table.hpp"

namespace lidarena {

/// Of a study that flies the same flights in several timing modes: drift, map and outliers of every
/// sensor and method, one column a mode, for each world and preset. None where there is one mode.
std::vector<ReportTable> timing_tables(const Results& results);

}  // namespace lidarena
