// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/report/decision.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <tuple>

#include "lidarena/results/study_cells.hpp"

namespace lidarena::report {
namespace {

constexpr double kSimilarRatio = 1.1;  // ratio below which two map errors count as equal

std::optional<double> map_rmse(const results::RunRecord& row) {
  return row.reprojected_map ? std::optional(row.reprojected_map->rmse_cm) : std::nullopt;
}
std::optional<double> outliers(const results::RunRecord& row) {
  return row.reprojected_map ? std::optional(row.reprojected_map->outliers_percent) : std::nullopt;
}
std::optional<double> period_share(const results::RunRecord& row) {
  if (!row.latency_p95_ms || !row.lidar.is_object()) return std::nullopt;
  return *row.latency_p95_ms * 1e-3 * row.lidar.value("rate_hz", 10.0);
}
std::optional<double> memory(const results::RunRecord& row) { return row.own_memory_mb; }

Candidate candidate(const results::StudyCells& cells, const std::string& world,
                    const std::string& sensor, const std::string& algorithm) {
  Candidate c;
  c.sensor = sensor;
  c.algorithm = algorithm;
  for (const results::RunRecord* row : cells.rows(world, sensor, algorithm)) {
    ++c.runs;
    const bool kept =
        row->status == "ok" && row->reprojected_map &&
        row->reprojected_map->outliers_percent < results::kTrackingLostOutliers_percent;
    c.good_runs += kept ? 1 : 0;
    c.variant = results::variant_of(*row);
  }
  const auto median = [&](const results::RowFigure& figure) {
    return cells.median(world, sensor, algorithm, figure).value_or(0.0);
  };
  c.map_rmse_cm = median(map_rmse);
  c.outliers_percent = median(outliers);
  c.drift_cm_per_m = median(results::rpe_of);
  c.period_share = cells.median(world, sensor, algorithm, period_share);
  c.memory_mb = median(memory);
  return c;
}

/// "fast_lio2", with its preset if that is not the default.
std::string name_of(const Candidate& c) {
  const bool usual = c.variant.empty() || c.variant == "indoor" || c.variant == "indoor-rolling" ||
                     c.variant == "rolling";
  return usual ? c.algorithm : c.algorithm + " (" + c.variant + ")";
}

std::string figures_of(const Candidate& c) {
  return fmt::format(
      "its map has an RMSE of {} cm to the mesh, with {} % of the points beyond 20 cm; its "
      "path drifts by {} cm per meter; 95 % of the scans are processed in less than {:.0f} % of "
      "the scan period, and the algorithm uses {} MB of memory",
      figure(c.map_rmse_cm, 2).text, figure(c.outliers_percent, 2).text,
      figure(c.drift_cm_per_m, 2).text, 100.0 * c.period_share.value_or(0.0),
      figure(c.memory_mb, 2).text);
}

/// Weight, power and price from the sensor's file: " (0.265 kg, up to 14 W, ...)".
std::string facts_of(const results::StudyResults& results, const std::string& sensor) {
  for (const results::RunRecord& row : results.rows) {
    if (row.sensor != sensor || !row.simulation.is_object()) continue;
    for (const Json& made : row.simulation.value("sensors", Json::array())) {
      if (made.value("name", "") != sensor || !made.contains("facts")) continue;
      const Json& facts = made.at("facts");
      std::vector<std::string> words;
      if (const double kg = facts.value("weight_kg", 0.0); kg > 0.0) {
        words.push_back(fmt::format("{:g} kg", kg));
      }
      if (const double watts = facts.value("power_max_w", 0.0); watts > 0.0) {
        words.push_back(fmt::format("up to {:g} W", watts));
      }
      if (const std::string price = facts.value("price", ""); !price.empty()) {
        words.push_back(price);
      }
      return words.empty() ? "" : fmt::format(" ({})", fmt::join(words, ", "));
    }
  }
  return "";
}

std::string recommendation(const results::StudyResults& results, const std::string& world,
                           const std::vector<Candidate>& all) {
  if (all.empty() || !all.front().is_usable()) {
    return fmt::format("{}: no combination that was tried keeps tracking in real time. ", world);
  }
  const Candidate& best = all.front();
  std::string text = fmt::format("{}: use the {}{} with {}: {}. ", world, best.sensor,
                                 facts_of(results, best.sensor), name_of(best), figures_of(best));
  std::vector<std::string> mentioned{best.sensor};
  for (const Candidate& c : all) {
    if (std::ranges::find(mentioned, c.sensor) != mentioned.end()) continue;
    mentioned.push_back(c.sensor);
    if (!c.is_usable()) {
      text += fmt::format("With the {}{}, no algorithm keeps tracking in real time. ", c.sensor,
                          facts_of(results, c.sensor));
      continue;
    }
    const double ratio = best.map_rmse_cm > 0.0 ? c.map_rmse_cm / best.map_rmse_cm : 1.0;
    text += fmt::format(
        "With the {}{}, {} is best, {}: {}. ", c.sensor, facts_of(results, c.sensor), name_of(c),
        ratio < kSimilarRatio
            ? std::string("with about the same map error, so that weight and price decide")
            : fmt::format("with {:.1f} times the map RMSE", ratio),
        figures_of(c));
  }
  return text;
}

std::string verdict(const Candidate& c) {
  if (!c.keeps_tracking())
    return fmt::format("tracking lost in {} of {}", c.runs - c.good_runs, c.runs);
  if (!c.period_share) return "time not measured";
  return c.is_real_time() ? "usable" : "too slow for real time";
}

ReportTable candidates_table(const std::string& world, const std::vector<Candidate>& all) {
  ReportTable table{
      "decision-" + world,
      "All combinations tried, " + world,
      "Usable: tracking kept in every run (less than half of the map beyond 20 cm), and 95 % of "
      "the scans processed within the scan period. Sorted by usability, then by map RMSE.",
      {"sensor, algorithm", "verdict", "map RMSE, cm", "map > 20 cm, %", "drift, cm per m",
       "P95, % of the period", "own memory, MB"},
      {}};
  for (const Candidate& c : all) {
    std::vector<TableCell> cells{word(c.sensor + ", " + name_of(c)), word(verdict(c))};
    for (const double value : {c.map_rmse_cm, c.outliers_percent, c.drift_cm_per_m, c.memory_mb}) {
      cells.push_back(c.map_rmse_cm > 0.0 ? figure(value) : word(""));
    }
    cells.insert(cells.end() - 1, c.period_share ? figure(100.0 * *c.period_share) : word(""));
    table.rows.push_back(std::move(cells));
  }
  return table;
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
    return std::tuple(!c.keeps_tracking(), !c.is_real_time(), c.good_runs == 0, c.map_rmse_cm);
  });
  return all;
}

ReportSection decision_section(const results::StudyResults& results) {
  ReportSection section{"decision", "Which LiDAR, which SLAM", "", "", {}};
  for (const std::string& world : results::StudyCells(results, "").worlds()) {
    const std::vector<Candidate> all = candidates(results, world);
    if (all.empty()) continue;
    if (!section.text.empty()) section.text += '\n';
    section.text += recommendation(results, world, all);
    section.tables.push_back(candidates_table(world, all));
  }
  return section;
}

}  // namespace lidarena::report
