// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/report/figure_tables.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <iterator>
#include <utility>
#include <vector>

#include "lidarena/report/page_claims.hpp"
#include "lidarena/report/summary_tables.hpp"
#include "lidarena/results/study_cells.hpp"

namespace lidarena::report {
namespace {

using results::number;
using results::StudyCells;
using results::StudyResults;
using results::Table;
using results::TableCell;
using results::word;

struct Kind {
  const char* id;
  const char* title;
  const results::Figure& figure;
};
const std::array kKinds{
    Kind{"drift", "RMSE of the drift of the final trajectory / as known live, cm per 1 m",
         results::kDrift},
    Kind{"live-drift", "RMSE of the drift of the live trajectory, cm per 1 m", results::kLiveDrift},
    Kind{"map", "Own map: RMSE of the point-to-mesh distance, cm", results::kOwnMapRmse},
    Kind{"map-all", "Sampled returns: RMSE of the point-to-mesh distance, cm", results::kMapRmse},
    Kind{"outliers", "Own map: points beyond 20 cm, %", results::kOwnMapOutliers},
    Kind{"map-vertices", "Own map: RMSE of the distance to the nearest vertex, cm",
         results::kOwnMapRmseToVertices},
    Kind{"outliers-vertices", "Own map: points farther than 20 cm from any vertex, %",
         results::kOwnMapBeyondVertices},
    Kind{"outliers-all", "Sampled returns: points beyond 20 cm, %", results::kMapOutliers},
    Kind{"cpu", "CPU time, % of one core", results::kCpuLoad}};

/// Whether the smallest of `cells` is at `index`.
bool is_smallest(const std::vector<TableCell*>& cells, std::size_t index) {
  return std::ranges::all_of(cells, [&](const TableCell* cell) {
    return !cell->value || (cells[index]->value && *cells[index]->value <= *cell->value);
  });
}

/// Underlines the best of each row, prints the best of each column in bold: where the claims and
/// the medians of this table agree.
void mark_best(Table& table, const std::string& world, const Kind& kind, const PageClaims& claims) {
  for (std::size_t s = 0; s < table.rows.size(); ++s) {
    for (std::size_t a = 1; a < table.head.size(); ++a) {
      std::vector<TableCell*> row, column;
      for (std::size_t i = 1; i < table.head.size(); ++i) row.push_back(&table.rows[s][i]);
      for (std::vector<TableCell>& other : table.rows) column.push_back(&other[a]);
      TableCell& cell = table.rows[s][a];
      const auto is_best = [&](bool among_methods) {
        return claims.is_best(kind.figure, world, table.rows[s][0].text, table.head[a],
                              among_methods);
      };
      cell.underlined = is_smallest(row, a - 1) && is_best(true);
      cell.bold = is_smallest(column, s) && is_best(false);
    }
  }
}

std::string published(std::optional<double> value) {
  return value ? fmt::format("{:g}", *value) : std::string();
}

/// One row per sensor and one column per algorithm.
Table accuracy_table(const StudyResults& results, const StudyCells& cells, const std::string& world,
                     const Kind& kind, const PageClaims& claims) {
  Table table;
  table.head = {"sensor"};
  for (const std::string& algorithm : cells.algorithms()) table.head.push_back(algorithm);
  for (const std::string& sensor : cells.sensors()) {
    std::vector<TableCell> row{word(sensor)};
    for (const std::string& algorithm : cells.algorithms()) {
      TableCell cell = cells.cell(world, sensor, algorithm, kind.figure);
      cell.reference =
          published(results::reference_of(results, world, sensor, algorithm, kind.figure.key));
      row.push_back(std::move(cell));
    }
    table.rows.push_back(std::move(row));
  }
  mark_best(table, world, kind, claims);
  return table;
}

/// Whether a table of this kind tells anything: some run has the figure; the live trajectory
/// differs from the final one in some run. Distances to vertices only stand beside published ones.
bool is_told(const StudyResults& results, const Kind& kind) {
  const bool is_to_vertices = &kind.figure == &results::kOwnMapRmseToVertices ||
                              &kind.figure == &results::kOwnMapBeyondVertices;
  const auto is_published = [&](const results::RunRecord& run) {
    return results::reference_of(results, run.world, run.sensor, run.algorithm, kind.figure.key)
        .has_value();
  };
  if (is_to_vertices && std::ranges::none_of(results.rows, is_published)) return false;
  return std::ranges::any_of(results.rows, [&](const results::RunRecord& run) {
    const auto value = results::value_of(run, kind.figure);
    return value && (&kind.figure != &results::kLiveDrift ||
                     value != results::value_of(run, results::kDrift));
  });
}

/// What the marks of a table mean, and which own maps are means.
std::string note_of(const StudyResults& results, const std::string& world, const Kind& kind,
                    const PageClaims& claims) {
  std::string note = fmt::format(
      "Medians over flights and seeds; behind them the range from the best run to the worst and "
      "how many of how many runs kept tracking: a lost run is the worst of its cell. \"ended at "
      "4.6 s [3.5]\": the methods ended themselves, with the drift until then. Bold: the best "
      "sensor for each algorithm; underlined: the best algorithm for each sensor, where the "
      "paired runs of this world pass Wilcoxon's test of log ratios (5 % after Holm's correction "
      "for all {} tests of these tables; here: {}). In brackets: published figures.",
      claims.tests(), claims.words(kind.figure, world));
  if (&kind.figure == &results::kOwnMapRmse || &kind.figure == &results::kOwnMapOutliers) {
    const std::string means = methods_with_mean_maps(results);
    if (!means.empty())
      note += " The own maps of " + means + " are means of several returns, which removes noise.";
  }
  return note;
}

/// From the datasets' descriptions of their sensors.
Table sensor_table(const StudyResults& results) {
  Table table{"sensors",
              "The sensors as simulated",
              "In brackets: published figures.",
              {"sensor", "shots, M/s", "maximum range, m", "rows", "scans/s"},
              {}};
  for (const std::string& sensor : StudyCells(results, "").sensors()) {
    const auto row = std::ranges::find_if(results.rows, [&](const results::RunRecord& r) {
      return r.sensor == sensor && r.lidar.has_value();
    });
    if (row == results.rows.end()) continue;
    const LidarInfo& lidar = *row->lidar;
    std::vector<TableCell> cells{
        word(sensor), number(lidar.rows * lidar.columns * lidar.rate_hz / 1e6),
        number(lidar.max_range_m), number(lidar.rows), number(lidar.rate_hz)};
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
std::optional<Table> increase_table(const StudyResults& results, const StudyCells& cells,
                                    const std::string& variant) {
  const std::vector<std::string> worlds = cells.worlds();
  if (worlds.size() != 2) return std::nullopt;
  const std::string& a = worlds[0];
  const std::string& b = worlds[1];
  Table table{
      "increase-" + variant,
      fmt::format("Increase of the final drift from {} to {}, %: {}", a, b, variant),
      fmt::format(
          "({1} - {0}) / {1}; \"usual\": ({1} - {0}) / {0}. In brackets: published figures.", a, b),
      {"sensor"},
      {}};
  for (const std::string& algorithm : cells.algorithms()) {
    table.head.insert(table.head.end(), {algorithm, algorithm + ", usual"});
  }
  for (const std::string& sensor : cells.sensors()) {
    std::vector<TableCell> row{word(sensor)};
    for (const std::string& algorithm : cells.algorithms()) {
      const results::Spread in_a = cells.spread(a, sensor, algorithm, results::kDrift);
      const results::Spread in_b = cells.spread(b, sensor, algorithm, results::kDrift);
      const auto theirs = [&](const std::string& world) {
        return results::reference_of(results, world, sensor, algorithm, results::kDrift.key);
      };
      for (const auto formula : {increase_of_last, increase}) {
        TableCell cell;
        if (in_a.median && in_b.median) {
          const bool lost = in_a.is_lost() || in_b.is_lost();
          cell = lost ? word("lost") : number(formula(*in_a.median, *in_b.median));
          cell.spread = fmt::format("{} of {}", in_a.kept + in_b.kept, in_a.runs + in_b.runs);
        }
        if (theirs(a) && theirs(b)) cell.reference = number(formula(*theirs(a), *theirs(b))).text;
        row.push_back(std::move(cell));
      }
    }
    table.rows.push_back(std::move(row));
  }
  return table;
}

/// One column per timing mode of the sensors.
Table timing_table(const StudyResults& results, const std::vector<std::string>& modes,
                   const std::string& world, const std::string& preset, const Kind& kind) {
  Table table{
      fmt::format("modes-{}-{}-{}", kind.id, world, preset),
      fmt::format("{}: {}, {}, by the simulator's timing", kind.title, world, preset),
      "rolling: every shot is cast from the pose at its own instant, as a real sensor does. "
      "frozen: all shots of a scan are cast from the pose at its stamp. frozen_unstamped: "
      "the same, without time stamps per point. frozen_ramp: the same, with time stamps that "
      "rise over a random length. official: like frozen_unstamped, and every "
      "range is too short by the sensor's minimum range, as in the manufacturer's "
      "simulation plugin.",
      {"sensor, algorithm"},
      {}};
  table.head.insert(table.head.end(), modes.begin(), modes.end());
  const StudyCells all(results, "");
  for (const std::string& sensor : all.sensors()) {
    for (const std::string& algorithm : all.algorithms()) {
      std::vector<TableCell> row{word(sensor + ", " + algorithm)};
      bool known = false;
      for (const std::string& mode : modes) {
        const StudyCells cells(results, results::variant_of(preset, mode));
        row.push_back(cells.cell(world, sensor, algorithm, kind.figure));
        known = known || !row.back().text.empty();
      }
      if (known) table.rows.push_back(std::move(row));
    }
  }
  return table;
}

}  // namespace

double increase_of_last(double a, double b) { return 100.0 * (b - a) / b; }

double increase(double a, double b) { return 100.0 * (b - a) / a; }

std::vector<Table> figure_tables(const StudyResults& results, const std::string& variant) {
  const StudyCells cells(results, variant);
  std::vector<Table> tables;
  if (Table sensors = sensor_table(results); !sensors.rows.empty()) {
    tables.push_back(std::move(sensors));
  }
  std::vector<const results::Figure*> told;
  for (const Kind& kind : kKinds) {
    if (is_told(results, kind)) told.push_back(&kind.figure);
  }
  std::vector<const results::Figure*> drifts;
  std::ranges::copy_if(told, std::back_inserter(drifts), [](const results::Figure* figure) {
    return figure == &results::kDrift || figure == &results::kLiveDrift;
  });
  const PageClaims claims(cells, told, drifts);
  for (const Kind& kind : kKinds) {
    if (std::ranges::find(told, &kind.figure) == told.end()) continue;
    for (const std::string& world : cells.worlds()) {
      Table table = accuracy_table(results, cells, world, kind, claims);
      table.id = fmt::format("{}-{}-{}", kind.id, world, variant);
      table.title =
          fmt::format("{}: {}", kind.title, variant.empty() ? world : world + ", " + variant);
      table.note = note_of(results, world, kind, claims);
      tables.push_back(std::move(table));
    }
    if (&kind != &kKinds[0]) continue;
    if (auto growth = increase_table(results, cells, variant)) tables.push_back(std::move(*growth));
    for (const results::Figure* drift : drifts)
      for (Table& ratios : claims.ratio_tables(*drift, variant))
        tables.push_back(std::move(ratios));
  }
  return tables;
}

std::vector<Table> timing_tables(const StudyResults& results) {
  const StudyCells all(results, "");
  std::vector<std::string> modes = all.modes();
  std::erase(modes, "");  // of further studies that set no mode
  std::vector<Table> tables;
  if (modes.size() < 2) return tables;
  for (const std::string& world : all.worlds()) {
    for (const std::string& preset : all.presets()) {
      for (const Kind& kind : kKinds) {
        if (!is_told(results, kind)) continue;
        Table table = timing_table(results, modes, world, preset, kind);
        if (!table.rows.empty()) tables.push_back(std::move(table));
      }
    }
  }
  return tables;
}

}  // namespace lidarena::report
