// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/report/paper_tables.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>

namespace lidarena::report {
namespace {

/// Columns of the paper's tables 2, 4 and 5.
constexpr std::array kAlgorithms{"CT ICP", "KISS ICP", "LIO SAM lc", "LIO SAM", "Fast LIO2"};

struct PaperRow {
  PaperTable table;
  const char* world;
  const char* sensor;
  std::array<double, 5> figures;
};

constexpr std::array kPaper{
    PaperRow{PaperTable::kDrift, "Cave", "Mid-360", {1.78, 3.34, 2.50, 2.61, 1.08}},
    PaperRow{PaperTable::kDrift, "Cave", "Os0-128", {1.53, 8.17, 1.26, 1.24, 0.49}},
    PaperRow{PaperTable::kDrift, "House", "Mid-360", {2.72, 6.88, 3.54, 2.70, 1.61}},
    PaperRow{PaperTable::kDrift, "House", "Os0-128", {2.79, 7.1, 1.65, 1.51, 1.11}},
    PaperRow{PaperTable::kOutliers, "Cave", "Mid-360", {14.95, 31.91, 3.68, 10.68, 15.59}},
    PaperRow{PaperTable::kOutliers, "Cave", "Os0-128", {1.40, 58.25, 0.17, 21.78, 0.18}},
    PaperRow{PaperTable::kOutliers, "House", "Mid-360", {0.13, 3.17, 4.24, 2.28, 5.92e-3}},
    PaperRow{PaperTable::kOutliers, "House", "Os0-128", {0.02, 0.45, 9.54e-4, 9.34e-4, 0.02}},
    PaperRow{PaperTable::kMapRmse, "Cave", "Mid-360", {20.06, 22.58, 9.99, 14.27, 19.98}},
    PaperRow{PaperTable::kMapRmse, "Cave", "Os0-128", {7.68, 51.47, 6.26, 17.19, 5.52}},
    PaperRow{PaperTable::kMapRmse, "House", "Mid-360", {6.45, 6.86, 6.95, 5.90, 5.27}},
    PaperRow{PaperTable::kMapRmse, "House", "Os0-128", {4.33, 4.88, 3.65, 4.19, 5.52}}};

std::string paper_text(std::optional<double> value) {
  return value ? fmt::format("{:g}", *value) : std::string();
}

/// One row per sensor and one column per algorithm, as in the paper.
ReportTable accuracy_table(const results::StudyCells& cells, const std::string& world,
                           PaperTable kind, const results::RowFigure& ours) {
  ReportTable table;
  table.head = {"sensor"};
  for (const std::string& algorithm : cells.algorithms()) table.head.push_back(algorithm);
  for (const std::string& sensor : cells.sensors()) {
    std::vector<TableCell> row{word(sensor)};
    for (const std::string& algorithm : cells.algorithms()) {
      TableCell cell = figure(cells.median(world, sensor, algorithm, ours));
      if (!cell.value) cell.text = cells.status_text(world, sensor, algorithm);
      cell.paper =
          paper_text(paper_figure(kind, results::paper_world(world), results::paper_sensor(sensor),
                                  results::paper_algorithm(algorithm)));
      row.push_back(std::move(cell));
    }
    table.rows.push_back(std::move(row));
  }
  mark_smallest(table);
  return table;
}

/// Table 1, from the datasets' descriptions of their sensors.
ReportTable sensor_table(const results::StudyResults& results) {
  // the paper's Table 1: points per second in millions, range in meters
  static const std::map<std::string, std::array<const char*, 2>> paper{{"Os0-128", {"2.4", "100"}},
                                                                       {"Mid-360", {"0.2", "40"}}};
  ReportTable table{"table1",
                    "Table 1: the sensors as simulated",
                    "In brackets: the paper's figures.",
                    {"sensor", "shots, M/s", "maximum range, m", "rows", "scans/s"},
                    {}};
  for (const std::string& sensor : results::StudyCells(results, "").sensors()) {
    const auto row = std::find_if(
        results.rows.begin(), results.rows.end(),
        [&](const results::RunRecord& r) { return r.sensor == sensor && r.lidar.is_object(); });
    if (row == results.rows.end()) continue;
    const auto number = [&](const char* key) { return row->lidar.value(key, 0.0); };
    const double rate = number("rate_hz");
    std::vector<TableCell> cells{
        word(sensor), figure(number("rows") * number("columns") * rate / 1e6),
        figure(number("max_range_m")), figure(number("rows")), figure(rate)};
    if (const auto known = paper.find(results::paper_sensor(sensor)); known != paper.end()) {
      cells[1].paper = known->second[0];
      cells[2].paper = known->second[1];
    }
    table.rows.push_back(std::move(cells));
  }
  return table;
}

/// The study's world that corresponds to the paper's `paper_name`; empty if there is none.
std::string world_called(const results::StudyCells& cells, const std::string& paper_name) {
  for (const std::string& world : cells.worlds()) {
    if (results::paper_world(world) == paper_name) return world;
  }
  return {};
}

std::optional<ReportTable> increase_table(const results::StudyCells& cells,
                                          const std::string& preset) {
  const std::string cave = world_called(cells, "Cave");
  const std::string house = world_called(cells, "House");
  if (cave.empty() || house.empty()) return std::nullopt;
  ReportTable table{"table3-" + preset,
                    "Table 3: increase of the drift from Cave to House, %",
                    "The paper divides by the House's drift: (house - cave) / house. \"usual\": "
                    "(house - cave) / cave. In brackets: the paper's figures.",
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
      const auto theirs = [&](const char* world) {
        return paper_figure(PaperTable::kDrift, world, results::paper_sensor(sensor),
                            results::paper_algorithm(algorithm));
      };
      for (const auto increase : {drift_increase_of_the_paper, drift_increase}) {
        TableCell cell;
        if (ours(cave) && ours(house)) cell = figure(increase(*ours(cave), *ours(house)));
        if (theirs("Cave") && theirs("House")) {
          cell.paper = figure(increase(*theirs("Cave"), *theirs("House"))).text;
        }
        row.push_back(std::move(cell));
      }
    }
    table.rows.push_back(std::move(row));
  }
  return table;
}

}  // namespace

std::optional<double> paper_figure(PaperTable table, const std::string& world,
                                   const std::string& sensor, const std::string& algorithm) {
  const auto column = std::find(kAlgorithms.begin(), kAlgorithms.end(), algorithm);
  if (column == kAlgorithms.end()) return std::nullopt;
  for (const PaperRow& row : kPaper) {
    if (row.table == table && world == row.world && sensor == row.sensor) {
      return row.figures[static_cast<std::size_t>(column - kAlgorithms.begin())];
    }
  }
  return std::nullopt;
}

double drift_increase_of_the_paper(double cave, double house) {
  return 100.0 * (house - cave) / house;
}

double drift_increase(double cave, double house) { return 100.0 * (house - cave) / cave; }

std::vector<ReportTable> paper_tables(const results::StudyResults& results,
                                      const std::string& preset) {
  const results::StudyCells cells(results, preset);
  struct Kind {
    const char* id;
    const char* title;
    PaperTable paper;
    results::RowFigure ours;
  };
  const std::vector<Kind> kinds{
      {"table2", "Table 2: RMSE of the drift, cm per 1 m", PaperTable::kDrift, results::rpe_of},
      {"table4", "Table 4: points of the map beyond 20 cm, %", PaperTable::kOutliers,
       results::outliers_of},
      {"table5", "Table 5: RMSE of the point-to-mesh distance, cm", PaperTable::kMapRmse,
       results::map_rmse_of}};
  std::vector<ReportTable> tables;
  if (ReportTable sensors = sensor_table(results); !sensors.rows.empty()) tables.push_back(sensors);
  for (const Kind& kind : kinds) {
    for (const std::string& world : cells.worlds()) {
      ReportTable table = accuracy_table(cells, world, kind.paper, kind.ours);
      table.id = fmt::format("{}-{}-{}", kind.id, world, preset);
      table.title = fmt::format("{}: {}, {}", kind.title, world, preset);
      table.note =
          "Bold: the best sensor for each algorithm; underlined: the best algorithm for each "
          "sensor; medians over flights and seeds; in brackets: the paper's figures.";
      tables.push_back(std::move(table));
    }
    if (kind.paper != PaperTable::kDrift) continue;
    if (auto increase = increase_table(cells, preset)) tables.push_back(std::move(*increase));
  }
  return tables;
}

}  // namespace lidarena::report
