// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/report/decision.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <tuple>

#include "lidarena/results/study_cells.hpp"

namespace lidarena::report {
namespace {

/// P95 of the processing time in scan periods.
std::optional<double> period_share(const results::RunRecord& row) {
  const auto latency_ms = results::value_of(row, results::kLatencyP95);
  if (!latency_ms || !row.lidar.is_object()) return std::nullopt;
  return *latency_ms * 1e-3 * row.lidar.value("rate_hz", 10.0);
}

Candidate candidate(const results::StudyCells& cells, const std::string& world,
                    const std::string& sensor, const std::string& algorithm) {
  Candidate c;
  c.sensor = sensor;
  c.algorithm = algorithm;
  for (const results::RunRecord* row : cells.rows(world, sensor, algorithm)) {
    ++c.runs;
    const auto outliers = results::value_of(*row, results::kMapOutliers);
    const bool kept =
        row->status == "ok" && outliers.value_or(100.0) < results::kTrackingLostOutliers_percent;
    c.good_runs += kept ? 1 : 0;
    c.variant = results::variant_of(*row);
  }
  const auto median = [&](const auto& figure) {
    return cells.median(world, sensor, algorithm, figure);
  };
  c.map_rmse_cm = median(results::kMapRmse);
  c.outliers_percent = median(results::kMapOutliers);
  c.drift_cm_per_m = median(results::kDrift);
  c.period_share = median(results::RowFigure(period_share));
  c.memory_mb = median(results::kOwnMemory);
  return c;
}

/// "fast_lio2", with its preset if that is not the default.
std::string name_of(const Candidate& c) {
  const bool usual = c.variant.empty() || c.variant == "indoor" || c.variant == "indoor-rolling" ||
                     c.variant == "rolling";
  return usual ? c.algorithm : c.algorithm + " (" + c.variant + ")";
}

}  // namespace

std::vector<Candidate> candidates(const results::StudyResults& results, const std::string& world) {
  std::vector<Candidate> all;
  std::set<std::string> seen;  // methods without presets occur in every variant
  for (const std::string& variant : results::variants_of(results)) {
    const results::StudyCells cells(results, variant);
    for (const std::string& sensor : cells.sensors()) {
      for (const std::string& algorithm : cells.algorithms()) {
        const auto rows = cells.rows(world, sensor, algorithm);
        if (rows.empty()) continue;
        if (const std::string& mode = rows.front()->mode; !mode.empty() && mode != "rolling") {
          continue;
        }
        if (!seen.insert(sensor + "|" + results::label_of(*rows.front())).second) continue;
        all.push_back(candidate(cells, world, sensor, algorithm));
      }
    }
  }
  std::ranges::stable_sort(all, {}, [](const Candidate& c) {
    return std::tuple(!c.keeps_tracking(), !c.is_real_time(), c.good_runs == 0,
                      c.map_rmse_cm.value_or(0.0));
  });
  return all;
}

std::string verdict(const Candidate& c) {
  if (!c.keeps_tracking())
    return fmt::format("tracking lost in {} of {}", c.runs - c.good_runs, c.runs);
  if (!c.period_share) return "time not measured";
  return c.is_real_time() ? "usable" : "too slow for real time";
}

results::Table decision_table(const results::StudyResults& results, const std::string& world) {
  results::Table table{
      "decision-" + world,
      "All combinations tried, " + world,
      "Usable: tracking kept in every run (less than half of the map beyond 20 cm), and 95 % of "
      "the scans processed within the scan period. Sorted by usability, then by map RMSE.",
      {"sensor, algorithm", "verdict", "map RMSE, cm", "map > 20 cm, %", "drift, cm per m",
       "P95, % of the period", "own memory, MB"},
      {}};
  for (const Candidate& c : candidates(results, world)) {
    table.rows.push_back(
        {results::word(c.sensor + ", " + name_of(c)), results::word(verdict(c)),
         results::number(c.map_rmse_cm), results::number(c.outliers_percent),
         results::number(c.drift_cm_per_m),
         results::number(c.period_share ? std::optional(100.0 * *c.period_share) : std::nullopt),
         results::number(c.memory_mb)});
  }
  return table;
}

}  // namespace lidarena::report
