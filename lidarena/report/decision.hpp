// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "lidarena/report/page.hpp"
#include "lidarena/results/run_record.hpp"

namespace lidarena::report {

/// A combination of sensor and algorithm in one world, with medians over flights and seeds.
struct Candidate {
  std::string sensor, algorithm, variant;
  std::size_t runs = 0, good_runs = 0;
  double map_rmse_cm = 0.0;            ///< of all scored returns, placed along the estimated path
  double outliers_percent = 0.0;       ///< of the same map
  double drift_cm_per_m = 0.0;         ///< RPE over 1 m
  std::optional<double> period_share;  ///< P95 of the processing time in scan periods, if measured
  double memory_mb = 0.0;              ///< the algorithm's own memory

  bool keeps_tracking() const { return runs > 0 && good_runs == runs; }
  bool is_real_time() const { return period_share && *period_share < 1.0; }
  bool is_usable() const { return keeps_tracking() && is_real_time(); }
};

/// All combinations of a world, the best first: usable ones, then too slow ones, then those that
/// lost tracking, each group sorted by map RMSE. Runs in a timing mode other than `rolling` (faults
/// of simulators) are left out.
std::vector<Candidate> candidates(const results::StudyResults& results, const std::string& world);

/// "Which LiDAR, which SLAM": for each world a recommendation, with the figures behind it.
ReportSection decision_section(const results::StudyResults& results);

}  // namespace lidarena::report
