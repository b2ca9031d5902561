// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/report/summary_tables.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "lidarena/report/run_command.hpp"
#include "lidarena/results/expectation.hpp"
#include "lidarena/results/lost.hpp"
#include "lidarena/results/study_cells.hpp"

namespace lidarena::report {
namespace {

using results::number;
using results::Table;
using results::TableCell;
using results::word;

/// The columns of the table of all runs after the coverage.
const std::array kShown{
    &results::kDrift,      &results::kLiveDrift, &results::kDriftRotation,  &results::kAte,
    &results::kOwnMapRmse, &results::kMapRmse,   &results::kOwnMapOutliers, &results::kMapOutliers,
    &results::kCpuLoad,    &results::kCpuP95,    &results::kOwnMemory};

/// RMSE of the map of a perfect estimate that is interpolated as the run's is, cm.
std::optional<double> interpolation_floor(const results::RunRecord& run) {
  return results::value_of(run, results::figure_of("interpolation_floor_rmse", "the report"));
}

/// The figure; a share of zero with its bound, a map of means named as one.
TableCell figure_cell(const results::RunRecord& run, const results::Figure& figure) {
  TableCell cell = number(results::value_of(run, figure));
  if (cell.value) cell.text = results::value_text(cell.value, results::zero_bound_of(run, figure));
  if (&figure == &results::kOwnMapRmse && cell.value && has_mean_map(run)) cell.text += ", means";
  if (&figure == &results::kMapRmse && is_bent_by_interpolation(run))
    cell.text += ", floor " + number(interpolation_floor(run)).text;
  return cell;
}

}  // namespace

Json facts_of(const results::RunRecord& row) {
  if (!row.simulation) return nullptr;
  for (const Json& made : row.simulation->sensors) {
    if (made.value("name", "") == row.sensor) return made.value("facts", Json());
  }
  return nullptr;
}

bool has_mean_map(const results::RunRecord& run) {
  return run.manifest && run.manifest->own_map == dataset::OwnMap::kMeans;
}

bool is_bent_by_interpolation(const results::RunRecord& run) {
  return interpolation_floor(run).has_value();
}

std::string methods_with_mean_maps(const results::StudyResults& results) {
  std::vector<std::string> names;
  for (const results::RunRecord& run : results.rows) {
    if (has_mean_map(run) && std::ranges::find(names, run.algorithm) == names.end())
      names.push_back(run.algorithm);
  }
  return fmt::format("{}", fmt::join(names, ", "));
}

Table runs_table(const results::StudyResults& results, const std::string& world) {
  Table table{
      "runs-" + world,
      "All runs, " + world,
      "RPE over 1 m, of the final trajectory and as known live. ATE after alignment by SE(3). Own "
      "map: as published by the algorithm (\"means\": its points are means of several returns); "
      "sampled returns: every k-th of a scan, at most 20,000, placed by the estimated motion. CPU "
      "time of all threads: "
      "share of one core, and P95 per scan. Own memory: map, scan buffer and backlog as the "
      "algorithm counts them. Below: the upper bound of a share of 0 of N points, 3/N.",
      {"sensor, algorithm, seed", "state", "coverage, %", "RPE, cm per m", "live RPE, cm per m",
       "RPE, deg per m", "ATE, cm", "own map RMSE, cm", "sampled returns RMSE, cm",
       "own map > 20 cm, %", "sampled returns > 20 cm, %", "CPU, % of a core", "CPU P95, ms",
       "own memory, MB"},
      {}};
  for (const results::RunRecord& row : results.rows) {
    if (row.world != world) continue;
    const std::string lost = results::lost_reason(row);
    std::vector<TableCell> cells{
        word(fmt::format("{}, {}, {}{}{}", row.sensor, results::label_of(row), row.seed,
                         row.variation.empty() ? "" : ", ", row.variation)),
        word(lost.empty() ? "ok" : lost), number(results::coverage_of(row))};
    for (const results::Figure* figure : kShown) cells.push_back(figure_cell(row, *figure));
    table.rows.push_back(std::move(cells));
  }
  return table;
}

Table failures_table(const results::StudyResults& results) {
  Table table{
      "failures", "Runs that are lost or have no result", "", {"run", "state", "reason"}, {}};
  for (const results::RunRecord& row : results.rows) {
    const std::string lost = results::lost_reason(row);
    if (lost.empty()) continue;
    table.rows.push_back({word(row.name), word(row.status == "ok" ? "lost" : row.status),
                          word(row.status == "ok" ? lost : row.reason)});
  }
  for (const results::RunRecord& row : results.without_result)
    table.rows.push_back({word(row.name), word(row.status), word(row.reason)});
  return table;
}

Table usual_table(const results::StudyResults& results, const std::string& world) {
  Table table{
      "usual-" + world,
      "By the usual names: " + world,
      "APE: RMSE of the positions after alignment by SE(3). RTF: real-time factor, seconds of "
      "data per second of computing. Success rate: runs that kept tracking. Medians over "
      "flights and seeds.",
      {"sensor, method", "APE, m", "RPE per second, m", "RTF", "success rate, %"},
      {}};
  const auto median = [](const results::Spread& spread) {
    return spread.median ? std::optional(0.01 * *spread.median) : std::nullopt;
  };
  const results::Figure& rpe = results::figure_of("rpe_1s_translation", "the report");
  const results::Figure& rtf = results::figure_of("real_time_factor", "the report");
  for (const std::string& variant : results::variants_of(results)) {
    const results::StudyCells cells(results, variant);
    for (const std::string& sensor : cells.sensors()) {
      for (const std::string& algorithm : cells.algorithms()) {
        const results::Runs runs = cells.rows(world, sensor, algorithm);
        if (runs.empty()) continue;
        const auto spread = [&](const results::Figure& figure) {
          return cells.spread(world, sensor, algorithm, figure);
        };
        const results::Spread ape = spread(results::kAte);
        table.rows.push_back(
            {word(sensor + ", " + results::label_of(*runs.front())), number(median(ape)),
             number(median(spread(rpe))), number(spread(rtf).median),
             number(100.0 * static_cast<double>(ape.kept) / static_cast<double>(ape.runs))});
      }
    }
  }
  return table;
}

Table commands_table(const results::StudyResults& results) {
  Table table{
      "commands",
      "Commands that reproduce each run",
      "The noise depends on seed and sensor only, so the same seed gives the same measurements. "
      "All sensors of a study are simulated on the same flight.",
      {"run", "commands"},
      {}};
  for (const results::RunRecord& row : results.rows) {
    table.rows.push_back({word(row.name), word(command_of(row))});
  }
  return table;
}

Table expectations_table(const results::StudyResults& results, const std::string& variant) {
  Table table{"expectations-" + variant,
              "What the study expects, " + variant,
              "An expectation holds if all of its checks hold; bold: what falls short.",
              {"expectation", "here", "check", "our figures"},
              {}};
  for (const results::Judgement& judged : results::judge(results, variant)) {
    const results::Expectation& e = judged.expectation;
    std::string evidence = fmt::format("{}", fmt::join(judged.evidence, "; "));
    const char* verdict = judged.holds              ? *judged.holds ? "holds" : "falls short"
                          : judged.evidence.empty() ? "not measured"
                                                    : "cannot be judged";
    if (judged.holds == false && !e.otherwise.empty())
      evidence += ". Possible reason: " + e.otherwise;
    table.rows.push_back({word(e.finding), word(verdict), word(e.rule), word(evidence)});
    table.rows.back()[1].bold = judged.holds == false;
  }
  return table;
}

}  // namespace lidarena::report
