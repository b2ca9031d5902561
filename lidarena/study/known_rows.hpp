// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>

#include "lidarena/study/plan.hpp"

namespace lidarena::study {

/// Rows of results.csv files that belong to a plan.
struct KnownRows {
  std::size_t taken = 0;  ///< cells that are done by such a row
  std::size_t other = 0;  ///< rows of cells that the plan has, made by other code or settings
};

/// Makes a folder in runs/ for each cell of the plan that has no result in the study `out` yet but
/// a row in `csv` with the same key: it counts as done, with the figures of the row and no other
/// files. Throws InputError if the file is not a results.csv.
KnownRows take_known_rows(const StudyPlan& plan, const std::filesystem::path& out,
                          const std::filesystem::path& csv);

}  // namespace lidarena::study
