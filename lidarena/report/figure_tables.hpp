// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "lidarena/results/run_record.hpp"
#include "lidarena/results/table.hpp"

namespace lidarena::report {

/// The growth of the drift from world `a` to world `b` in percent of the last one: (b - a) / b.
double increase_of_last(double a, double b);
/// The usual definition: (b - a) / a, in percent.
double increase(double a, double b);

/// Drift (final, and live where that differs), own map and map of sampled returns, CPU time of the
/// runs of one variant by sensor and algorithm, for each world; the growth of the drift between the
/// worlds of a study of two; the sensors as simulated. Published figures of the study's `reference`
/// stand beside.
std::vector<results::Table> figure_tables(const results::StudyResults& results,
                                          const std::string& variant);

/// If the study has several timing modes: drift, map RMSE and outliers with a column for each.
std::vector<results::Table> timing_tables(const results::StudyResults& results);

}  // namespace lidarena::report
