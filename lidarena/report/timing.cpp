// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/report/timing.hpp"

#include <fmt/format.h>

#include <array>

#include "lidarena/results/study_cells.hpp"

namespace lidarena::report {
namespace {

struct Kind {
  const char* id;
  const char* title;
  std::optional<double> (*figure)(const results::RunRecord&);
};
constexpr std::array kKinds{
    Kind{"drift", "RMSE of the drift, cm per 1 m", results::rpe_of},
    Kind{"map", "RMSE of the point-to-mesh distance, cm", results::map_rmse_of},
    Kind{"outliers", "Points of the map beyond 20 cm, %", results::outliers_of}};

ReportTable timing_table(const results::StudyResults& results,
                         const std::vector<std::string>& modes, const std::string& world,
                         const std::string& preset, const Kind& kind) {
  ReportTable table{fmt::format("modes-{}-{}-{}", kind.id, world, preset),
                    fmt::format("{}: {}, {}", kind.title, world, preset),
                    "",
                    {"sensor, algorithm"},
                    {}};
  table.head.insert(table.head.end(), modes.begin(), modes.end());
  const results::StudyCells all(results, "");
  for (const std::string& sensor : all.sensors()) {
    for (const std::string& algorithm : all.algorithms()) {
      std::vector<TableCell> row{word(sensor + ", " + algorithm)};
      bool known = false;
      for (const std::string& mode : modes) {
        const results::StudyCells cells(results, results::variant_of(preset, mode));
        TableCell cell = figure(cells.median(world, sensor, algorithm, kind.figure));
        if (!cell.value) cell.text = cells.status_text(world, sensor, algorithm);
        known = known || !cell.text.empty();
        row.push_back(std::move(cell));
      }
      if (known) table.rows.push_back(std::move(row));
    }
  }
  return table;
}

}  // namespace

std::vector<ReportTable> timing_tables(const results::StudyResults& results) {
  const results::StudyCells all(results, "");
  std::vector<std::string> modes = all.modes();
  std::erase(modes, "");  // of further studies that set no mode
  std::vector<ReportTable> tables;
  if (modes.size() < 2) return tables;
  for (const std::string& world : all.worlds()) {
    for (const std::string& preset : all.presets()) {
      for (const Kind& kind : kKinds) {
        ReportTable table = timing_table(results, modes, world, preset, kind);
        if (!table.rows.empty()) tables.push_back(std::move(table));
      }
    }
  }
  return tables;
}

}  // namespace lidarena::report
