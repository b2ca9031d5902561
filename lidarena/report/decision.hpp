// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "lidarena/results/run_record.hpp"
#include "lidarena/results/table.hpp"

namespace lidarena::report {

/// A combination of sensor and algorithm in one world, with medians over flights and seeds.
struct Candidate {
  std::string sensor, algorithm, variant;
  std::size_t runs = 0, good_runs = 0;
  std::optional<double> map_rmse_cm;       ///< of all scored returns along the estimated path
  std::optional<double> outliers_percent;  ///< of the same map
  std::optional<double> drift_cm_per_m;    ///< RPE over 1 m
  std::optional<double> period_share;      ///< P95 of the processing time in scan periods
  std::optional<double> memory_mb;         ///< the algorithm's own memory

  bool keeps_tracking() const { return runs > 0 && good_runs == runs; }
  bool is_real_time() const { return period_share && *period_share < 1.0; }
  bool is_usable() const { return keeps_tracking() && is_real_time(); }
};

/// All combinations of a world, the best first: usable ones, then too slow ones, then those that
/// lost tracking, each group sorted by map RMSE. Runs in a timing mode other than `rolling` (faults
/// of simulators) are left out.
std::vector<Candidate> candidates(const results::StudyResults& results, const std::string& world);

/// "usable", or what is against it.
std::string verdict(const Candidate& candidate);

/// The candidates of a world with their figures.
results::Table decision_table(const results::StudyResults& results, const std::string& world);

}  // namespace lidarena::report
