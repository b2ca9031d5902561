// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/results/known_row.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "lidarena/dataset/text_file.hpp"
#include "lidarena/results/figures.hpp"

namespace lidarena::results {
namespace {

/// Parts between commas; a part in quotes may have commas, and quotes that are written twice.
std::vector<std::string> split_csv(std::string_view row, const std::string& place) {
  std::vector<std::string> parts(1);
  bool quoted = false;
  for (std::size_t i = 0; i < row.size(); ++i) {
    if (row[i] == '"' && quoted && i + 1 < row.size() && row[i + 1] == '"') {
      parts.back() += row[++i];
    } else if (row[i] == '"') {
      quoted = !quoted;
    } else if (row[i] == ',' && !quoted) {
      parts.emplace_back();
    } else {
      parts.back() += row[i];
    }
  }
  if (quoted) throw InputError(place, "has a quote that is not closed");
  return parts;
}

std::map<std::string, double> bounds_of(const std::string& text, const std::string& place) {
  std::map<std::string, double> bounds;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find(';', begin), text.size());
    const std::size_t equals = text.find('=', begin);
    if (equals >= end) throw InputError(place, "has a bound without a value: " + text);
    bounds[text.substr(begin, equals - begin)] =
        dataset::finite_number(text.substr(equals + 1, end - equals - 1), place);
    begin = end + 1;
  }
  return bounds;
}

KnownRow row_of(const std::map<std::string, std::string>& cells, const std::string& place) {
  const auto text = [&](const std::string& column) {
    const auto cell = cells.find(column);
    return cell == cells.end() ? std::string() : cell->second;
  };
  const auto value = [&](const std::string& column) -> std::optional<double> {
    if (text(column).empty()) return std::nullopt;
    return dataset::finite_number(text(column), place + ": " + column);
  };
  KnownRow row{text("run"),
               text("key"),
               text("algorithm"),
               text("preset"),
               text("sensor"),
               text("status"),
               text("reason"),
               {},
               {},
               {},
               {},
               {}};
  value_from_json(Json(text("own_map")), row.own_map, place);
  row.coverage_percent = value("coverage_percent");
  row.ended_at_s = value("ended_at_s");
  for (const Figure& figure : figures()) {
    const std::string column = column_of(figure);
    if (const auto known = value(column)) row.figures[column] = *known;
  }
  row.zero_bounds = bounds_of(text("zero_bounds"), place);
  return row;
}

}  // namespace

std::vector<KnownRow> read_known_rows(const std::filesystem::path& csv) {
  dataset::TextRows rows(csv);
  const std::vector<std::string> head = split_csv(rows.next().value_or(""), rows.place());
  for (const char* column : {"run", "key", "status"}) {
    if (std::ranges::find(head, column) == head.end())
      throw InputError(csv.string(), fmt::format("has no column '{}'", column),
                       "give the results.csv of a study of this version");
  }
  std::vector<KnownRow> known;
  while (const auto line = rows.next()) {
    const std::vector<std::string> parts = split_csv(*line, rows.place());
    if (parts.size() != head.size())
      throw InputError(rows.place(),
                       fmt::format("has {} columns, not {}", parts.size(), head.size()));
    std::map<std::string, std::string> cells;
    for (std::size_t i = 0; i < head.size(); ++i) cells[head[i]] = parts[i];
    KnownRow row = row_of(cells, rows.place());
    if (!row.key.empty()) known.push_back(std::move(row));
  }
  return known;
}

std::string bounds_text(const std::map<std::string, double>& bounds) {
  std::string text;
  for (const auto& [key, bound] : bounds)
    text += fmt::format("{}{}={}", text.empty() ? "" : ";", key, bound);
  return text;
}

}  // namespace lidarena::results
