// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/results/changes.hpp"

#include <algorithm>
#include <tuple>

#include "lidarena/results/lost.hpp"
#include "lidarena/results/summary.hpp"

namespace lidarena::results {
namespace {

/// World, sensor, method.
using Cell = std::tuple<std::string, std::string, std::string>;

Cell cell_of(const RunRecord& run) { return {run.world, run.sensor, label_of(run)}; }

std::vector<RunFigure> figures_in(const StudyResults& results, const Cell& cell,
                                  const std::string& variation, const Figure& figure) {
  std::vector<RunFigure> values;
  for (const RunRecord& run : results.rows) {
    if (run.variation != variation || cell_of(run) != cell) continue;
    values.push_back(judged_figure(run, figure));
    values.back().flight += " " + values.back().seed;  // each seed has its own route and gusts
  }
  return values;
}

}  // namespace

std::vector<Change> changes_of(const StudyResults& results,
                               std::span<const Figure* const> figures) {
  std::vector<std::pair<Cell, std::string>> seen;
  for (const RunRecord& run : results.rows) {
    const std::pair key(cell_of(run), run.variation);
    if (run.differs.size() == 1 && std::ranges::find(seen, key) == seen.end()) seen.push_back(key);
  }
  std::vector<Change> changes;
  for (const Figure* figure : figures) {
    for (const auto& [cell, variation] : seen) {
      const auto& [world, sensor, method] = cell;
      PairedComparison paired = compare_paired(figures_in(results, cell, "", *figure),
                                               figures_in(results, cell, variation, *figure));
      if (paired.pairs > 0)
        changes.push_back({world, sensor, method, figure, variation, std::move(paired)});
    }
  }
  return changes;
}

}  // namespace lidarena::results
