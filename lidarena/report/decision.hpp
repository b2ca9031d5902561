// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "lidarena/results/run_record.hpp"
#include "lidarena/results/statistics.hpp"
#include "lidarena/results/table.hpp"

namespace lidarena::report {

/// A property by which combinations of sensor and method are compared; less is better.
struct Criterion {
  const char* key;
  const char* label;
  const char* unit;
  double weight;                  ///< by default, in the order of the page
  const results::Figure* figure;  ///< median over flights and seeds; null: a fact of the sensor
};
/// Drift, map, CPU time, weight, power and price.
std::span<const Criterion> criteria();

/// A combination of sensor and method in one world.
struct Candidate {
  std::string sensor, algorithm, variant;
  std::vector<const results::RunRecord*> runs;  ///< in this world
  std::size_t kept = 0;                         ///< runs that are not lost
  /// Of criteria(); infinite: the median is that of a lost run; empty: not known.
  std::vector<std::optional<double>> values;
  std::vector<results::TableCell> cells;  ///< the same as text, with the range over the runs
  results::TableCell own_map;             ///< RMSE of the own map, cm; says if that is of means
  std::optional<bool> is_real_time;       ///< see verdict(); empty: not measured
  bool on_front = false;     ///< keeps tracking, and no other one that does dominates it
  std::string dominated_by;  ///< which one dominates it, and what a test says of that

  bool keeps_tracking() const { return !runs.empty() && kept == runs.size(); }
};

/// All combinations of a world: first the Pareto front, then what is dominated, then what lost
/// track, each by its drift. One dominates another if it is no worse in every criterion and better
/// in one; a criterion that is known of one of them alone forbids it. Whether the difference is
/// more than chance is tested over the paired runs of all worlds (results/claims.hpp). Runs in a
/// timing mode other than `rolling` (faults of simulators) are left out.
std::vector<Candidate> candidates(const results::StudyResults& results, const std::string& world);

/// "lost in 1 of 8", else "real time on one core" (at most 5 % of the scans of each run take more
/// CPU time than their period; in paced runs more time by the clock), "too slow for one core" or
/// "time not measured".
std::string verdict(const Candidate& candidate);

/// The candidates of a world with their figures.
results::Table decision_table(const results::StudyResults& results, const std::string& world);

}  // namespace lidarena::report
