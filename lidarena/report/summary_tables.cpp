// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/report/summary_tables.hpp"

#include <fmt/format.h>

#include <array>

#include "lidarena/base/shell_word.hpp"
#include "lidarena/results/expectation.hpp"
#include "lidarena/results/study_cells.hpp"

namespace lidarena::report {
namespace {

using results::number;
using results::Table;
using results::TableCell;
using results::word;

/// The columns of the table of all runs; the coverage follows the third.
const std::array kShown{&results::kDrift,       &results::kDriftRotation,  &results::kAte,
                        &results::kOwnMapRmse,  &results::kOwnMapOutliers, &results::kMapRmse,
                        &results::kMapOutliers, &results::kRealTimeFactor, &results::kLatencyP95,
                        &results::kOwnMemory};

/// The smallest figure with its algorithm: "fast_lio2 (indoor): 0.84"; empty if there is none.
std::string smallest_figure(const results::StudyResults& results, const std::string& world,
                            const std::string& sensor, const results::Figure& of) {
  std::optional<double> best;
  std::string text;
  for (const std::string& preset : results::variants_of(results)) {
    const results::StudyCells cells(results, preset);
    for (const std::string& algorithm : cells.algorithms()) {
      const auto value = cells.median(world, sensor, algorithm, of);
      if (!value || (best && *best <= *value)) continue;
      best = value;
      const results::RunRecord& row = *cells.rows(world, sensor, algorithm).front();
      text = fmt::format("{}: {}", results::label_of(row), number(value).text);
    }
  }
  return text;
}

std::string simulate_command(const results::RunRecord& row) {
  const Json& made = row.simulation;
  if (!made.is_object()) return "(the dataset was not simulated by lidarena)";
  std::string command =
      fmt::format("lidarena simulate --world {} --flight {}", shell_word(row.world),
                  shell_word(row.flight.empty() ? made.value("flight_source", "") : row.flight));
  for (const Json& sensor : made.value("sensors", Json::array())) {
    command += " --sensor " + shell_word(sensor.value("name", ""));
  }
  if (made.contains("seed")) command += fmt::format(" --seed {}", made.at("seed").dump());
  if (made.contains("seconds")) command += fmt::format(" --seconds {}", made.at("seconds").dump());
  if (!row.mode.empty()) command += " --mode " + shell_word(row.mode);
  if (!made.value("noise", true)) command += " --noise off";
  return command + " --no-data --out data";
}

}  // namespace

std::string command_of(const results::RunRecord& row) {
  const std::string preset = row.preset.empty() ? "" : " --preset " + shell_word(row.preset);
  return fmt::format("{} && lidarena run {} data{} --sensor {} --out run && lidarena evaluate run",
                     simulate_command(row), shell_word(row.algorithm), preset,
                     shell_word(row.sensor));
}

Json facts_of(const results::RunRecord& row) {
  if (!row.simulation.is_object()) return nullptr;
  for (const Json& made : row.simulation.value("sensors", Json::array())) {
    if (made.value("name", "") == row.sensor) return made.value("facts", Json());
  }
  return nullptr;
}

Table winners_table(const results::StudyResults& results) {
  Table table{"winners",
              "Best algorithm for each world and sensor",
              "Medians over flights and seeds of the successful runs.",
              {"world, sensor", "lowest drift, cm per m", "fewest points beyond 20 cm, %"},
              {}};
  const results::StudyCells all(results, "");
  for (const std::string& world : all.worlds()) {
    for (const std::string& sensor : all.sensors()) {
      table.rows.push_back(
          {word(world + ", " + sensor),
           word(smallest_figure(results, world, sensor, results::kDrift)),
           word(smallest_figure(results, world, sensor, results::kOwnMapOutliers))});
    }
  }
  return table;
}

Table runs_table(const results::StudyResults& results, const std::string& world) {
  Table table{
      "runs-" + world,
      "All runs, " + world,
      "RPE over 1 m. ATE after alignment by SE(3). Own map: as published by the algorithm; all "
      "returns: at most 20,000 of a scan, placed by the estimated motion. P95 of the processing "
      "time per "
      "scan. Own memory: map, scan buffer and backlog as the algorithm counts them.",
      {"sensor, algorithm, seed", "RPE, cm per m", "RPE, deg per m", "ATE, cm", "coverage, %",
       "own map RMSE, cm", "own map > 20 cm, %", "all returns RMSE, cm", "all returns > 20 cm, %",
       "times real time", "P95, ms", "own memory, MB"},
      {}};
  for (const results::RunRecord& row : results.rows) {
    if (row.world != world) continue;
    std::vector<TableCell> cells{
        word(fmt::format("{}, {}, {}", row.sensor, results::label_of(row), row.seed))};
    for (const results::Figure* figure : kShown) {
      cells.push_back(number(results::value_of(row, *figure)));
    }
    const auto coverage = row.metrics ? results::coverage_of(*row.metrics) : std::nullopt;
    cells.insert(cells.begin() + 4, number(coverage));
    if (row.status != "ok") cells[1] = word(row.status + ": " + row.reason);
    table.rows.push_back(std::move(cells));
  }
  return table;
}

Table failures_table(const results::StudyResults& results) {
  Table table{"failures", "Runs that did not succeed", "", {"run", "state", "reason"}, {}};
  for (const results::RunRecord& row : results.rows) {
    if (row.status == "ok") continue;
    table.rows.push_back({word(row.name), word(row.status), word(row.reason)});
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
