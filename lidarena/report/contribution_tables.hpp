// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "lidarena/results/contributions.hpp"
#include "lidarena/results/table.hpp"

namespace lidarena::report {

/// The contributions that the report shows: to drift (final and live), maps and outliers; see
/// contributions_of().
std::vector<results::Contributions> shown_contributions(const results::StudyResults& results);

/// For each world and figure: a row for the base, for each change, and for all of them; a column
/// per sensor and method. The note names the changes whose intervals exclude zero, and those whose
/// do not.
std::vector<results::Table> contribution_tables(
    const std::vector<results::Contributions>& contributions);

}  // namespace lidarena::report
