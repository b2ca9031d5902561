// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/report/figure_tables.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "lidarena/results/study_cells.hpp"

namespace lidarena::report {
namespace {

using results::StudyCells;
using results::StudyResults;

struct Kind {
  const char* id;
  const char* title;
  const char* figure;  ///< key of the published figure
  std::optional<double> (*ours)(const results::RunRecord&);
};
constexpr std::array kKinds{
    Kind{"drift", "RMSE of the drift, cm per 1 m", "rpe_1m_at_poses_translation", results::rpe_of},
    Kind{"outliers", "Points of the map beyond 20 cm, %", "own_map_outliers", results::outliers_of},
    Kind{"map", "RMSE of the point-to-mesh distance, cm", "own_map_rmse", results::map_rmse_of}};

std::string published(std::optional<double> value) {
  return value ? fmt::format("{:g}", *value) : std::string();
}

/// One row per sensor and one column per algorithm.
ReportTable accuracy_table(const StudyResults& results, const StudyCells& cells,
                           const std::string& world, const Kind& kind) {
  ReportTable table;
  table.head = {"sensor"};
  for (const std::string& algorithm : cells.algorithms()) table.head.push_back(algorithm);
  for (const std::string& sensor : cells.sensors()) {
    std::vector<TableCell> row{word(sensor)};
    for (const std::string& algorithm : cells.algorithms()) {
      TableCell cell = figure(cells.median(world, sensor, algorithm, kind.ours));
      if (!cell.value) cell.text = cells.status_text(world, sensor, algorithm);
      cell.reference =
          published(results::reference_of(results, world, sensor, algorithm, kind.figure));
      row.push_back(std::move(cell));
    }
    table.rows.push_back(std::move(row));
  }
  mark_smallest(table);
  return table;
}

/// From the datasets' descriptions of their sensors.
ReportTable sensor_table(const StudyResults& results) {
  ReportTable table{"sensors",
                    "The sensors as simulated",
                    "In brackets: published figures.",
                    {"sensor", "shots, M/s", "maximum range, m", "rows", "scans/s"},
                    {}};
  for (const std::string& sensor : StudyCells(results, "").sensors()) {
    const auto row = std::ranges::find_if(results.rows, [&](const results::RunRecord& r) {
      return r.sensor == sensor && r.lidar.is_object();
    });
    if (row == results.rows.end()) continue;
    const auto number = [&](const char* key) { return row->lidar.value(key, 0.0); };
    const double rate = number("rate_hz");
    std::vector<TableCell> cells{
        word(sensor), figure(number("rows") * number("columns") * rate / 1e6),
        figure(number("max_range_m")), figure(number("rows")), figure(rate)};
    const auto known = [&](const char* key) {
      return published(results::reference_of(results, "", sensor, "", key));
    };
    cells[1].reference = known("sensor_million_shots_per_s");
    cells[2].reference = known("sensor_max_range_m");
    table.rows.push_back(std::move(cells));
  }
  return table;
}

/// Of the drift between the two worlds of a study; empty if it has another number of worlds.
std::optional<ReportTable> increase_table(const StudyResults& results, const StudyCells& cells,
                                          const std::string& variant) {
  const std::vector<std::string> worlds = cells.worlds();
  if (worlds.size() != 2) return std::nullopt;
  const std::string& a = worlds[0];
  const std::string& b = worlds[1];
  ReportTable table{
      "increase-" + variant,
      fmt::format("Increase of the drift from {} to {}, %: {}", a, b, variant),
      fmt::format("({1} - {0}) / {1}, as Vultaggio et al. 2023 define it; \"usual\": ({1} - {0}) / "
                  "{0}. In brackets: published figures.",
                  a, b),
      {"sensor"},
      {}};
  for (const std::string& algorithm : cells.algorithms()) {
    table.head.insert(table.head.end(), {algorithm, algorithm + ", usual"});
  }
  for (const std::string& sensor : cells.sensors()) {
    std::vector<TableCell> row{word(sensor)};
    for (const std::string& algorithm : cells.algorithms()) {
      const auto ours = [&](const std::string& world) {
        return cells.median(world, sensor, algorithm, results::rpe_of);
      };
      const auto theirs = [&](const std::string& world) {
        return results::reference_of(results, world, sensor, algorithm, kKinds[0].figure);
      };
      for (const auto formula : {increase_of_last, increase}) {
        TableCell cell;
        if (ours(a) && ours(b)) cell = figure(formula(*ours(a), *ours(b)));
        if (theirs(a) && theirs(b)) cell.reference = figure(formula(*theirs(a), *theirs(b))).text;
        row.push_back(std::move(cell));
      }
    }
    table.rows.push_back(std::move(row));
  }
  return table;
}

}  // namespace

double increase_of_last(double a, double b) { return 100.0 * (b - a) / b; }

double increase(double a, double b) { return 100.0 * (b - a) / a; }

std::vector<ReportTable> figure_tables(const StudyResults& results, const std::string& variant) {
  const StudyCells cells(results, variant);
  std::vector<ReportTable> tables;
  if (ReportTable sensors = sensor_table(results); !sensors.rows.empty()) {
    tables.push_back(std::move(sensors));
  }
  for (const Kind& kind : kKinds) {
    for (const std::string& world : cells.worlds()) {
      ReportTable table = accuracy_table(results, cells, world, kind);
      table.id = fmt::format("{}-{}-{}", kind.id, world, variant);
      table.title = fmt::format("{}: {}, {}", kind.title, world, variant);
      table.note =
          "Bold: the best sensor for each algorithm; underlined: the best algorithm for each "
          "sensor; medians over flights and seeds; in brackets: published figures.";
      tables.push_back(std::move(table));
    }
    if (&kind != &kKinds[0]) continue;
    if (auto growth = increase_table(results, cells, variant)) tables.push_back(std::move(*growth));
  }
  return tables;
}

}  // namespace lidarena::report
