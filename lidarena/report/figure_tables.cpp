// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/report/figure_tables.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

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
    Kind{"drift", "RMSE of the drift, cm per 1 m", results::kDrift},
    Kind{"outliers", "Points of the map beyond 20 cm, %", results::kOwnMapOutliers},
    Kind{"map", "RMSE of the point-to-mesh distance, cm", results::kOwnMapRmse}};

/// Sets `mark` of the cell with the smallest value, if at least two cells have a value.
void mark_smallest(const std::vector<TableCell*>& cells, bool TableCell::*mark) {
  std::vector<TableCell*> measured;
  std::ranges::copy_if(cells, std::back_inserter(measured),
                       [](const TableCell* cell) { return cell->value.has_value(); });
  if (measured.size() < 2) return;
  (*std::ranges::min_element(measured, {}, [](const TableCell* c) { return *c->value; }))->*mark =
      true;
}

/// Marks the smallest value of each column (bold) and row (underlined).
void mark_smallest(Table& table) {
  for (std::vector<TableCell>& row : table.rows) {
    std::vector<TableCell*> cells;
    for (TableCell& cell : row) cells.push_back(&cell);
    mark_smallest(cells, &TableCell::underlined);
  }
  for (std::size_t column = 1; column < table.head.size(); ++column) {
    std::vector<TableCell*> cells;
    for (std::vector<TableCell>& row : table.rows) cells.push_back(&row.at(column));
    mark_smallest(cells, &TableCell::bold);
  }
}

std::string published(std::optional<double> value) {
  return value ? fmt::format("{:g}", *value) : std::string();
}

/// The median, or how many runs did not succeed.
TableCell cell_of(const StudyCells& cells, const std::string& world, const std::string& sensor,
                  const std::string& algorithm, const Kind& kind) {
  TableCell cell = number(cells.median(world, sensor, algorithm, kind.figure));
  if (!cell.value) cell.text = cells.status_text(world, sensor, algorithm);
  return cell;
}

/// One row per sensor and one column per algorithm.
Table accuracy_table(const StudyResults& results, const StudyCells& cells, const std::string& world,
                     const Kind& kind) {
  Table table;
  table.head = {"sensor"};
  for (const std::string& algorithm : cells.algorithms()) table.head.push_back(algorithm);
  for (const std::string& sensor : cells.sensors()) {
    std::vector<TableCell> row{word(sensor)};
    for (const std::string& algorithm : cells.algorithms()) {
      TableCell cell = cell_of(cells, world, sensor, algorithm, kind);
      cell.reference =
          published(results::reference_of(results, world, sensor, algorithm, kind.figure.key));
      row.push_back(std::move(cell));
    }
    table.rows.push_back(std::move(row));
  }
  mark_smallest(table);
  return table;
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
      return r.sensor == sensor && r.lidar.is_object();
    });
    if (row == results.rows.end()) continue;
    const auto fact = [&](const char* key) { return row->lidar.value(key, 0.0); };
    const double rate = fact("rate_hz");
    std::vector<TableCell> cells{word(sensor), number(fact("rows") * fact("columns") * rate / 1e6),
                                 number(fact("max_range_m")), number(fact("rows")), number(rate)};
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
        return cells.median(world, sensor, algorithm, results::kDrift);
      };
      const auto theirs = [&](const std::string& world) {
        return results::reference_of(results, world, sensor, algorithm, results::kDrift.key);
      };
      for (const auto formula : {increase_of_last, increase}) {
        TableCell cell;
        if (ours(a) && ours(b)) cell = number(formula(*ours(a), *ours(b)));
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
      "the same, without time stamps per point. official: like frozen_unstamped, and every "
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
        row.push_back(cell_of(cells, world, sensor, algorithm, kind));
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
  for (const Kind& kind : kKinds) {
    for (const std::string& world : cells.worlds()) {
      Table table = accuracy_table(results, cells, world, kind);
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

std::vector<Table> timing_tables(const StudyResults& results) {
  const StudyCells all(results, "");
  std::vector<std::string> modes = all.modes();
  std::erase(modes, "");  // of further studies that set no mode
  std::vector<Table> tables;
  if (modes.size() < 2) return tables;
  for (const std::string& world : all.worlds()) {
    for (const std::string& preset : all.presets()) {
      for (const Kind& kind : kKinds) {
        Table table = timing_table(results, modes, world, preset, kind);
        if (!table.rows.empty()) tables.push_back(std::move(table));
      }
    }
  }
  return tables;
}

}  // namespace lidarena::report
