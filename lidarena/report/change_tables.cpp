// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/report/change_tables.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "lidarena/report/table_parts.hpp"

namespace lidarena::report {
namespace {

using results::Change;
using results::Table;
using results::TableCell;

const std::array kRanked{&results::kDrift, &results::kLiveDrift, &results::kOwnMapRmse,
                         &results::kMapRmse};

std::string column_name(const Change& change) { return change.sensor + ", " + change.method; }

/// Below zero if the change is for the better.
double judged(const Change& change, double value) {
  return change.figure->better == results::Better::kMore ? -value : value;
}

bool is_better(const Change& change) {
  const auto& interval = change.paired.difference_95;
  return interval && judged(change, interval->low) < 0.0 && judged(change, interval->high) < 0.0;
}

bool is_worse(const Change& change) {
  const auto& interval = change.paired.difference_95;
  return interval && judged(change, interval->low) > 0.0 && judged(change, interval->high) > 0.0;
}

std::string signed_text(double value) {
  const std::string text = results::number(value).text;
  return value > 0.0 && std::isfinite(value) ? "+" + text : text;
}

TableCell change_cell(const Change& change) {
  TableCell cell = difference_cell(change.paired);
  cell.bold = is_better(change) || is_worse(change);
  return cell;
}

/// What the intervals say of a column, and no more.
std::string words_of(const std::string& column, const std::vector<const Change*>& changes) {
  std::vector<std::string> better, worse, open;
  for (const Change* change : changes) {
    if (column_name(*change) != column) continue;
    (is_better(*change) ? better : is_worse(*change) ? worse : open).push_back(change->variation);
  }
  return fmt::format(" {}: better: {}; worse: {}; neither is shown: {}.", column,
                     names_text(better), names_text(worse), names_text(open));
}

/// Of one world and figure; `changes` from the best to the worst.
Table table_of(const std::vector<const Change*>& changes) {
  const Change& first = *changes.front();
  Table table{fmt::format("ranking-{}-{}", first.figure->key, first.world),
              fmt::format("{}, {}: {}, change by each variation", first.figure->label,
                          first.figure->unit, first.world),
              "Medians of the differences from the base on the same flights and seeds; behind them "
              "the interval at 95 %, by bootstrap. Bold: the interval excludes zero.",
              {"variation"},
              {}};
  std::vector<std::string> variations;
  for (const Change* change : changes) {
    if (std::ranges::find(table.head, column_name(*change)) == table.head.end())
      table.head.push_back(column_name(*change));
    if (std::ranges::find(variations, change->variation) == variations.end())
      variations.push_back(change->variation);
  }
  for (const std::string& variation : variations) table.rows.push_back({results::word(variation)});
  for (auto column = table.head.begin() + 1; column != table.head.end(); ++column) {
    table.note += words_of(*column, changes);
    for (std::size_t i = 0; i < variations.size(); ++i) {
      const auto change = std::ranges::find_if(changes, [&](const Change* c) {
        return c->variation == variations[i] && column_name(*c) == *column;
      });
      table.rows[i].push_back(change == changes.end() ? TableCell{} : change_cell(**change));
    }
  }
  return table;
}

}  // namespace

TableCell difference_cell(const results::PairedComparison& paired) {
  if (paired.pairs == 0) return {};
  TableCell cell = results::number(paired.median_difference);
  cell.text = signed_text(paired.median_difference);
  if (const auto& interval = paired.difference_95)
    cell.spread = signed_text(interval->low) + " to " + signed_text(interval->high);
  return cell;
}

std::vector<Change> shown_changes(const results::StudyResults& results) {
  return results::changes_of(results, kRanked);
}

std::vector<Table> change_tables(const std::vector<Change>& changes) {
  std::vector<Table> tables;
  for (std::vector<const Change*> group : by_world_and_figure(changes)) {
    const std::string column = column_name(*group.front());
    std::ranges::stable_sort(group, {}, [&](const Change* change) {
      const bool is_first = column_name(*change) == column;
      return std::pair(!is_first, judged(*change, change->paired.median_difference));
    });
    tables.push_back(table_of(group));
  }
  return tables;
}

}  // namespace lidarena::report
