// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/results/study_cells.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "lidarena/results/lost.hpp"
#include "lidarena/results/summary.hpp"

namespace lidarena::results {
namespace {

std::vector<std::string> distinct(const Runs& rows, std::string RunRecord::*member) {
  std::vector<std::string> values;
  for (const RunRecord* row : rows) {
    if (std::find(values.begin(), values.end(), row->*member) == values.end()) {
      values.push_back(row->*member);
    }
  }
  return values;
}

/// Whether a row is compared within the variant. Methods without presets are compared with every
/// preset of the others, within their mode.
bool belongs_to(const RunRecord& row, const std::string& variant) {
  if (variant.empty() || variant_of(row) == variant) return true;
  return row.preset.empty() && (row.mode.empty() || variant.ends_with("-" + row.mode));
}

}  // namespace

StudyCells::StudyCells(const StudyResults& results, const std::string& variant) {
  for (const RunRecord& row : results.rows) {
    if (row.variation.empty() && belongs_to(row, variant)) rows_.push_back(&row);
  }
}

std::vector<std::string> StudyCells::worlds() const { return distinct(rows_, &RunRecord::world); }
std::vector<std::string> StudyCells::sensors() const { return distinct(rows_, &RunRecord::sensor); }
std::vector<std::string> StudyCells::algorithms() const {
  return distinct(rows_, &RunRecord::algorithm);
}
std::vector<std::string> StudyCells::presets() const { return distinct(rows_, &RunRecord::preset); }
std::vector<std::string> StudyCells::modes() const { return distinct(rows_, &RunRecord::mode); }

Runs StudyCells::rows(const std::string& world, const std::string& sensor,
                      const std::string& algorithm) const {
  Runs found;
  std::ranges::copy_if(rows_, std::back_inserter(found), [&](const RunRecord* row) {
    return (world.empty() || row->world == world) && row->sensor == sensor &&
           row->algorithm == algorithm;
  });
  return found;
}

Spread StudyCells::spread(const std::string& world, const std::string& sensor,
                          const std::string& algorithm, const Figure& figure) const {
  std::vector<RunFigure> values;
  for (const RunRecord* row : rows(world, sensor, algorithm))
    values.push_back(judged_figure(*row, figure));
  return spread_of(values, figure.better, 1, 0);
}

TableCell StudyCells::cell(const std::string& world, const std::string& sensor,
                           const std::string& algorithm, const Figure& figure) const {
  const Spread of = spread(world, sensor, algorithm, figure);
  TableCell cell = spread_cell(of);
  if (cell.text.empty()) cell.text = status_text(world, sensor, algorithm);
  if (of.is_lost()) {
    if (const std::string end = ended_text(world, sensor, algorithm, figure); !end.empty())
      cell.text = end;
  } else if (&figure == &kDrift && of.median) {
    cell.live = number(spread(world, sensor, algorithm, kLiveDrift).median).text;
  }
  return cell;
}

std::string StudyCells::ended_text(const std::string& world, const std::string& sensor,
                                   const std::string& algorithm, const Figure& figure) const {
  std::vector<double> times, drifts;
  for (const RunRecord* row : rows(world, sensor, algorithm)) {
    if (!is_lost(*row)) continue;
    const std::optional<EarlyEnd> end = early_end(*row);
    if (!end) return {};
    times.push_back(end->at_s);
    if (end->drift) drifts.push_back(*end->drift);
  }
  if (times.empty()) return {};
  const std::string text = fmt::format("ended at {:.1f} s", quantile(times, 0.5));
  if (&figure != &kDrift || drifts.empty()) return text;
  return fmt::format("{} [{}]", text, number(quantile(drifts, 0.5)).text);
}

std::string StudyCells::status_text(const std::string& world, const std::string& sensor,
                                    const std::string& algorithm) const {
  const Runs all = rows(world, sensor, algorithm);
  std::map<std::string, std::size_t> states;
  for (const RunRecord* row : all) {
    if (!is_lost(*row)) continue;
    ++states[row->status == "ok" ? "lost" : early_end(*row) ? "ended itself" : row->status];
  }
  std::string text;
  for (const auto& [state, count] : states) {
    text += (text.empty() ? "" : ", ") +
            (all.size() == 1 ? state : fmt::format("{} of {} {}", count, all.size(), state));
  }
  return text;
}

std::vector<std::string> variants_of(const StudyResults& results) {
  const bool without_presets =
      std::ranges::all_of(results.rows, [](const RunRecord& row) { return row.preset.empty(); });
  std::vector<std::string> variants;
  for (const RunRecord& row : results.rows) {
    if (row.preset.empty() && !without_presets) continue;
    const std::string variant = variant_of(row);
    if (std::ranges::find(variants, variant) == variants.end()) variants.push_back(variant);
  }
  std::ranges::stable_partition(
      variants, [](const std::string& variant) { return variant.starts_with("indoor"); });
  return variants;
}

}  // namespace lidarena::results
