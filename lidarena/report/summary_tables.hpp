// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "lidarena/results/run_record.hpp"
#include "lidarena/results/table.hpp"

namespace lidarena::report {

/// What the file of the run's sensor says of the device: weight, power, price; null if nothing.
Json facts_of(const results::RunRecord& row);

/// Whether the points of the run's own map are means of several returns.
bool has_mean_map(const results::RunRecord& run);
/// Whether its map of returns was made with poses interpolated between the estimates, since the
/// method told no motion within its scans: that bends a map even if every pose is perfect.
bool is_bent_by_interpolation(const results::RunRecord& run);
/// The algorithms with such maps: "arena_lio+loop, lio_sam"; empty if there is none.
std::string methods_with_mean_maps(const results::StudyResults& results);

/// All runs of a world with all their figures; lost runs are rows, too.
results::Table runs_table(const results::StudyResults& results, const std::string& world);
/// Lost runs (results/lost.hpp) with their reasons.
results::Table failures_table(const results::StudyResults& results);
/// The runs of the base in a world by the names that other benchmarks use: APE, RPE per second,
/// real-time factor, success rate.
results::Table usual_table(const results::StudyResults& results, const std::string& world);
/// The commands that reproduce each run, including its dataset.
results::Table commands_table(const results::StudyResults& results);
/// The study's expectations, judged by the runs of one variant: "holds", "falls short", "cannot be
/// judged" or "not measured", with the figures.
results::Table expectations_table(const results::StudyResults& results, const std::string& variant);

}  // namespace lidarena::report
