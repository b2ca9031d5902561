// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/report/contribution_tables.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <utility>

#include "lidarena/report/table_parts.hpp"

namespace lidarena::report {
namespace {

using results::Contribution;
using results::Contributions;
using results::Table;
using results::TableCell;

const std::array kContributed{&results::kDrift, &results::kLiveDrift, &results::kOwnMapRmse,
                              &results::kMapRmse, &results::kOwnMapOutliers};

TableCell contribution_cell(const Contribution& part) {
  TableCell cell = results::number(part.value);
  if (part.value > 0.0) cell.text = "+" + cell.text;
  if (part.value_95) {
    cell.spread = results::number(part.value_95->low).text + " to " +
                  results::number(part.value_95->high).text;
    cell.bold = part.value_95->low > 0.0 || part.value_95->high < 0.0;
  }
  return cell;
}

/// What the intervals say, and no more.
std::string contribution_words(const Contributions& c) {
  const std::string who = c.sensor + ", " + c.method + ": ";
  if (!c.missing.empty()) return who + c.missing + ".";
  std::vector<std::string> better, worse, open;
  const bool more_is_better = c.figure->better == results::Better::kMore;
  for (const Contribution& part : c.parts) {
    const bool is_up = part.value_95 && part.value_95->low > 0.0;
    const bool is_down = part.value_95 && part.value_95->high < 0.0;
    if (!is_up && !is_down) {
      open.push_back(part.name);
    } else {
      (is_up == more_is_better ? better : worse).push_back(part.name);
    }
  }
  return fmt::format("{}{} flights; better with {}; worse with {}; open: {}.", who, c.flights,
                     names_text(better), names_text(worse), names_text(open));
}

Table contribution_table(std::span<const Contributions* const> columns) {
  const Contributions& first = *columns.front();
  Table table{
      fmt::format("contributions-{}-{}", first.figure->key, first.world),
      fmt::format("{}, {}: {}, what each change contributes", first.figure->label,
                  first.figure->unit, first.world),
      "Shapley values of all combinations, of medians; behind them the interval at 95 %, by "
      "bootstrap over flights and seeds. Bold: the interval excludes zero. They add up to "
      "the difference between the last row and the first.",
      {"change"},
      {}};
  std::vector<std::string> names{"base"};
  for (const Contributions* column : columns) {
    table.head.push_back(column->sensor + ", " + column->method);
    table.note += " " + contribution_words(*column);
    for (const Contribution& part : column->parts)
      if (std::ranges::find(names, part.name) == names.end()) names.push_back(part.name);
  }
  names.emplace_back("all");
  for (const std::string& name : names) {
    std::vector<TableCell> row{results::word(name)};
    for (const Contributions* column : columns) {
      const auto part = std::ranges::find(column->parts, name, &Contribution::name);
      if (part != column->parts.end())
        row.push_back(contribution_cell(*part));
      else if (column->flights > 0 && (name == "base" || name == "all"))
        row.push_back(results::number(name == "base" ? column->base : column->all));
      else
        row.emplace_back();
    }
    table.rows.push_back(std::move(row));
  }
  return table;
}

}  // namespace

std::vector<Contributions> shown_contributions(const results::StudyResults& results) {
  return contributions_of(results, kContributed);
}

std::vector<Table> contribution_tables(const std::vector<Contributions>& contributions) {
  std::vector<Table> tables;
  for (const auto& group : by_world_and_figure(contributions))
    tables.push_back(contribution_table(group));
  return tables;
}

}  // namespace lidarena::report
