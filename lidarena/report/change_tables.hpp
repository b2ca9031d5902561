// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "lidarena/results/changes.hpp"
#include "lidarena/results/table.hpp"

namespace lidarena::report {

/// The median difference with its sign and its interval; empty without pairs.
results::TableCell difference_cell(const results::PairedComparison& paired);

/// The changes that the report ranks: of drift (final and live) and maps; see
/// results::changes_of().
std::vector<results::Change> shown_changes(const results::StudyResults& results);

/// For each world and figure: a row per variation, from the best change of the first column to the
/// worst, and a column per sensor and method. The note names the variations that are better, those
/// that are worse, and those of which the interval says neither.
std::vector<results::Table> change_tables(const std::vector<results::Change>& changes);

}  // namespace lidarena::report
