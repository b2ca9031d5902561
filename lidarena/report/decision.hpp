// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "lidarena/report/page.hpp"
#include "lidarena/report/result_table.hpp"

namespace lidarena {

/// A sensor with an algorithm in one world: medians over flights and seeds.
struct Candidate {
  std::string sensor, algorithm, reading;
  std::size_t runs = 0, good_runs = 0;
  double map_rmse_cm = 0.0;       ///< of all scored returns moved with the estimated path
  double outliers_percent = 0.0;  ///< of these
  double drift_cm_per_m = 0.0;    ///< RPE over 1 m
  std::optional<double> busy;     ///< P95 of the time for a scan, in scan periods, if measured
  double memory_mb = 0.0;         ///< the algorithm's own

  bool keeps_track() const { return runs > 0 && good_runs == runs; }
  bool is_in_time() const { return busy && *busy < 1.0; }
  bool is_usable() const { return keeps_track() && is_in_time(); }
};

/// All of a world, the best first: usable ones before late ones before those that lost track, each
/// by the error of the map. Faults of simulators (other modes than `rolling`) are no candidates.
std::vector<Candidate> candidates(const Results& results, const std::string& world);

/// "Which LiDAR, which SLAM": for each world the choice in words, with the figures behind it.
ReportSection decision_section(const Results& results);

}  // namespace lidarena
