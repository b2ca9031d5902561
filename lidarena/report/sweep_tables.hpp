// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "lidarena/results/run_record.hpp"
#include "lidarena/results/table.hpp"

namespace lidarena::report {

/// Of a study that varies settings: for each world and each of drift (final and live), maps and CPU
/// time, a row per variation (the base first) and a column per sensor and method. Empty for any
/// other study.
std::vector<results::Table> sweep_tables(const results::StudyResults& results);

}  // namespace lidarena::report
