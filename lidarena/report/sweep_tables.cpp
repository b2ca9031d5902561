// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/report/sweep_tables.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "lidarena/results/lost.hpp"
#include "lidarena/results/statistics.hpp"

namespace lidarena::report {
namespace {

using results::RunRecord;
using results::StudyResults;
using results::Table;

const std::array kFigures{&results::kDrift,   &results::kLiveDrift,      &results::kOwnMapRmse,
                          &results::kMapRmse, &results::kOwnMapOutliers, &results::kCpuLoad};

template <class Name>
std::vector<std::string> distinct(const std::vector<RunRecord>& runs, const Name& name_of) {
  std::vector<std::string> names;
  for (const RunRecord& run : runs) {
    const std::string name = name_of(run);
    if (std::ranges::find(names, name) == names.end()) names.push_back(name);
  }
  return names;
}

std::string column_of(const RunRecord& run) { return run.sensor + ", " + results::label_of(run); }

/// The runs of a cell as medians; empty where none was planned, since it would be that of the base.
results::TableCell cell_of(const StudyResults& results, const std::string& world,
                           const std::string& variation, const std::string& column,
                           const results::Figure& figure) {
  std::vector<results::RunFigure> values;
  for (const RunRecord& run : results.rows) {
    if (run.world == world && run.variation == variation && column_of(run) == column)
      values.push_back(results::judged_figure(run, figure));
  }
  return results::spread_cell(results::spread_of(values, figure.better, 1, 0));
}

Table table_of(const StudyResults& results, const std::string& world,
               const std::vector<std::string>& variations, const std::vector<std::string>& columns,
               const results::Figure& figure) {
  Table table{
      fmt::format("sweep-{}-{}", figure.key, world),
      fmt::format("{}, {}: {}, by variation", figure.label, figure.unit, world),
      "Medians over flights and seeds; behind them the range from the best run to the worst "
      "and how many of how many runs kept tracking. An empty cell is that of the base.",
      {"variation"},
      {}};
  table.head.insert(table.head.end(), columns.begin(), columns.end());
  for (const std::string& variation : variations) {
    std::vector<results::TableCell> row{results::word(variation.empty() ? "base" : variation)};
    for (const std::string& column : columns)
      row.push_back(cell_of(results, world, variation, column, figure));
    table.rows.push_back(std::move(row));
  }
  return table;
}

}  // namespace

std::vector<Table> sweep_tables(const StudyResults& results) {
  const auto variations =
      distinct(results.rows, [](const RunRecord& run) { return run.variation; });
  std::vector<Table> tables;
  if (variations.size() < 2) return tables;
  const auto columns = distinct(results.rows, column_of);
  for (const std::string& world :
       distinct(results.rows, [](const RunRecord& run) { return run.world; })) {
    for (const results::Figure* figure : kFigures) {
      const bool is_known = std::ranges::any_of(results.rows, [&](const RunRecord& run) {
        return results::value_of(run, *figure).has_value();
      });
      if (is_known) tables.push_back(table_of(results, world, variations, columns, *figure));
    }
  }
  return tables;
}

}  // namespace lidarena::report
