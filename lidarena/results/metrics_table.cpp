// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/results/metrics_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <numbers>
#include <optional>
#include <vector>

#include "lidarena/base/angle.hpp"
#include "lidarena/base/config_json.hpp"
#include "lidarena/results/figures.hpp"
#include "lidarena/results/lost.hpp"
#include "lidarena/results/table.hpp"

namespace lidarena::results {
namespace {

bool has_coverage(const Figure& figure) { return figure.subject != Subject::kResources; }

// --- terminal

/// The numbers, "?" for those that are not known.
template <class Numbers>
std::string list_text(const Numbers& numbers, double factor = 1.0) {
  std::string text;
  for (const std::optional<double> number : numbers) {
    text += number ? fmt::format(" {:.4g}", *number * factor) : " ?";
  }
  return text;
}

std::string lever_text(const std::optional<LeverArmMetrics>& arm) {
  if (!arm) return "not observable from this motion";
  return fmt::format("at{} m, rotated by{} deg (a diagnostic, not applied)",
                     list_text(arm->position_m),
                     list_text(arm->rotation_vector_rad, kDegreesPerRadian));
}

std::string alignment_text(const AteMetrics& se3) {
  if (se3.refused) return fmt::format("  SE(3) alignment refused: {}\n", *se3.refused);
  if (!se3.truth_from_estimate) return {};
  const Eigen::Vector3d t = se3.truth_from_estimate->translation();
  const Eigen::Quaterniond q(se3.truth_from_estimate->linear());
  return fmt::format("  SE(3) alignment x y z qx qy qz qw:{}, scale hint {:.5f} (not applied)\n",
                     list_text(std::array{t.x(), t.y(), t.z(), q.x(), q.y(), q.z(), q.w()}),
                     se3.scale_hint.value_or(1.0));
}

std::string diagnosis_text(const TrajectoryMetrics& trajectory) {
  const AssociationMetrics& a = trajectory.association;
  std::string text = fmt::format(
      "  {} of {} poses matched, coverage {:.1f} %, overlap {:.2f} s, longest gap {:.2f} "
      "s\n  rates: estimate {:.4g} Hz, truth {:.4g} Hz; stamps late by {}\n",
      a.matched, a.estimates, 100 * a.coverage, a.overlap_s, a.longest_gap_s, a.estimate_rate_hz,
      a.truth_rate_hz,
      a.time_offset_s ? fmt::format("{:.1f} +- {:.1f} ms (not corrected)", 1e3 * *a.time_offset_s,
                                    1e3 * a.time_offset_sigma_s.value_or(0))
                      : "an amount that is not observable from this motion");
  text += "  estimate's frame in the truth's body: " + lever_text(a.lever_arm) + "\n";
  return trajectory.ate ? text + alignment_text(trajectory.ate->se3) : text;
}

const char* block_of(const Figure& figure) {
  switch (figure.subject) {
    case Subject::kMap:
      return "map";
    case Subject::kResources:
      return "resources";
    default:
      return "trajectory";
  }
}

std::string figure_text(const RunMetrics& metrics, const Figure& figure, const Reading& reading) {
  if (!reading.value && !reading.refused.empty())
    return fmt::format("  {:<38}   refused: {}\n", figure.label, reading.refused);
  if (!reading.value) return {};
  std::string line = fmt::format("  {:<38}{:>10.3f} {:<4}", figure.label,
                                 *reading.value * figure.factor, figure.unit);
  const auto coverage = coverage_of(metrics, figure);
  if (has_coverage(figure) && coverage) {
    line += fmt::format("  coverage {:.0f} %{}{}", *coverage, reading.samples.empty() ? "" : ", ",
                        reading.samples);
  }
  if (const auto bound = zero_bound(reading)) line += fmt::format(", below {:.2g} %", *bound);
  if (!reading.warning.empty()) line += " (" + reading.warning + ")";
  line.erase(line.find_last_not_of(' ') + 1);
  return line + "\n";
}

// --- tables

/// The columns of a table; in the map table only those that some run has.
std::vector<const Figure*> table_figures(std::span<const ScoredRun> runs, FigureTable table) {
  std::vector<const Figure*> columns;
  for (const Figure& figure : figures()) {
    if (figure.table != table) continue;
    const bool known = std::any_of(runs.begin(), runs.end(), [&](const ScoredRun& run) {
      return value_of(run.metrics, figure).has_value();
    });
    if (known || table == FigureTable::kMain) columns.push_back(&figure);
  }
  return columns;
}

std::string title_of(const ScoredRun& run) {
  return run.algorithm.empty() ? run.name : run.name + " (" + run.algorithm + ")";
}

Table table_of(std::span<const ScoredRun> runs, const std::vector<const Figure*>& columns) {
  Table table{"", "", "", {"run", "coverage %"}, {}};
  for (const Figure* figure : columns) table.head.emplace_back(figure->heading);
  table.head.emplace_back("status");
  for (const ScoredRun& run : runs) {
    std::vector<TableCell> row{word(title_of(run)), number(coverage_of(run.metrics))};
    for (const Figure* figure : columns) {
      row.push_back(number(value_of(run.metrics, *figure)));
      row.back().text = value_text(row.back().value, zero_bound(figure->read(run.metrics)));
    }
    const std::string lost = lost_reason(run.metrics);
    row.push_back(word(lost.empty() ? "ok" : lost));
    table.rows.push_back(std::move(row));
  }
  return table;
}

/// The main table and, if a run has further metrics of its re-projected map, a second one.
std::string tables_text(std::span<const ScoredRun> runs, std::string (*write)(const Table&)) {
  const std::string text = write(table_of(runs, table_figures(runs, FigureTable::kMain)));
  const auto map_figures = table_figures(runs, FigureTable::kMap);
  return map_figures.empty() ? text : text + "\n" + write(table_of(runs, map_figures));
}

}  // namespace

std::string metrics_text(const ScoredRun& run) {
  const RunMetrics& m = run.metrics;
  std::string text = fmt::format("{}\nstatus: {}\n", title_of(run), m.status_and_reason());
  if (m.is_ok() && !lost_reason(m).empty()) text += lost_reason(m) + "\n";
  if (m.ended_at_s)
    text += fmt::format("it ended itself at {:.1f} s; the figures are until then\n", *m.ended_at_s);
  for (const std::string& warning : m.warnings) text += fmt::format("warning: {}\n", warning);
  if (m.final) text += diagnosis_text(*m.final);
  const bool live_is_final = m.live && m.final && value_to_json(*m.live) == value_to_json(*m.final);
  std::string block, refused;
  for (const Figure& figure : figures()) {
    if (live_is_final && figure.subject == Subject::kLiveTrajectory) continue;
    const Reading reading = figure.read(m);
    if (!reading.refused.empty() && reading.refused == refused) continue;  // said already
    refused = reading.refused;
    const std::string line = figure_text(m, figure, reading);
    if (!line.empty() && block != block_of(figure)) {
      block = block_of(figure);
      text += block + "\n";
    }
    text += line;
  }
  return text;
}

std::string metrics_csv(std::span<const ScoredRun> runs) {
  std::string csv =
      "run,algorithm,flight,seed,status,reason,coverage_percent,figure,definition,value,unit,used,"
      "total\n";
  for (const ScoredRun& run : runs) {
    const std::string head =
        fmt::format("{},{},{},{},{},{}", csv_quoted(run.name), csv_quoted(run.algorithm),
                    csv_quoted(run.flight), csv_quoted(run.seed), run.metrics.status,
                    csv_quoted(run.metrics.reason));
    bool any = false;
    for (const Figure& figure : figures()) {
      const Reading reading = figure.read(run.metrics);
      if (!reading.value) continue;
      any = true;
      const auto coverage =
          has_coverage(figure) ? coverage_of(run.metrics, figure) : std::optional<double>();
      const auto count = [](const std::optional<std::size_t>& n) {
        return n ? std::to_string(*n) : std::string();
      };
      csv += fmt::format("{},{},{},{},{:.9g},{},{},{}\n", head,
                         coverage ? fmt::format("{:.3f}", *coverage) : "", figure.key,
                         csv_quoted(reading.definition), *reading.value * figure.factor,
                         figure.unit, count(reading.used), count(reading.total));
    }
    if (!any) csv += head + ",,,,,,,\n";
  }
  return csv;
}

std::string metrics_markdown(std::span<const ScoredRun> runs) {
  return tables_text(runs, table_markdown);
}

std::string metrics_latex(std::span<const ScoredRun> runs) {
  return tables_text(runs, table_latex);
}

}  // namespace lidarena::results
