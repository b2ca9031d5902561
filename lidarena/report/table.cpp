// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/report/table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "lidarena/report/svg.hpp"

namespace lidarena::report {
namespace {

std::string shown(const TableCell& cell, const char* dash) {
  return cell.text.empty() ? dash : cell.text;
}

std::string latex_escaped(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (std::string_view("&%$#_{}").find(c) != std::string_view::npos) out += '\\';
    out += c;
  }
  return out;
}

std::string csv_quoted(const std::string& text) {
  if (text.find_first_of(",\"\n") == std::string::npos) return text;
  std::string out = "\"";
  for (const char c : text) out += c == '"' ? "\"\"" : std::string(1, c);
  return out + "\"";
}

/// Whether a column is aligned left: it is the first, or has words and no figure.
bool holds_words(const ReportTable& table, std::size_t column) {
  if (column == 0) return true;
  bool words = false;
  for (const auto& row : table.rows) {
    if (column >= row.size()) continue;
    if (row[column].value) return false;
    words = words || !row[column].text.empty();
  }
  return words;
}

std::string html_cell(const TableCell& cell, bool words) {
  std::string text = escaped(cell.text);
  if (text.empty()) text = "&ndash;";
  if (cell.best_in_row) text = "<u>" + text + "</u>";
  if (cell.best_in_column) text = "<b>" + text + "</b>";
  if (!cell.reference.empty()) {
    text += " <span class='reference'>(" + escaped(cell.reference) + ")</span>";
  }
  const bool left = words || (!cell.value && !cell.text.empty());  // a status among figures
  return fmt::format("<td{}>{}</td>", left ? " class='l'" : "", text);
}

std::string markdown_cell(const TableCell& cell) {
  std::string text = shown(cell, "-");
  if (cell.best_in_row) text = "<u>" + text + "</u>";
  if (cell.best_in_column) text = "**" + text + "**";
  return cell.reference.empty() ? text : text + " (" + cell.reference + ")";
}

std::string latex_cell(const TableCell& cell) {
  std::string text = latex_escaped(shown(cell, "--"));
  if (cell.best_in_row) text = "\\underline{" + text + "}";
  if (cell.best_in_column) text = "\\textbf{" + text + "}";
  return cell.reference.empty() ? text : text + " (" + latex_escaped(cell.reference) + ")";
}

/// Sets `mark` of the cell with the smallest value, if at least two cells have a value.
void mark(const std::vector<TableCell*>& cells, bool TableCell::*mark) {
  std::vector<TableCell*> measured;
  std::copy_if(cells.begin(), cells.end(), std::back_inserter(measured),
               [](const TableCell* cell) { return cell->value.has_value(); });
  if (measured.size() < 2) return;
  const auto best = std::min_element(
      measured.begin(), measured.end(),
      [](const TableCell* a, const TableCell* b) { return *a->value < *b->value; });
  (*best)->*mark = true;
}

}  // namespace

TableCell word(std::string text) {
  TableCell cell;
  cell.text = std::move(text);
  return cell;
}

TableCell figure(std::optional<double> value, int digits) {
  TableCell cell;
  if (!value || !std::isfinite(*value)) return cell;
  cell.value = value;
  const double size = std::abs(*value);
  const bool whole = size >= 1.0 && size < 1e6 && size == std::floor(size);
  const int before = size >= 1.0 ? static_cast<int>(std::log10(size)) + 1 : 1;
  cell.text = whole                       ? fmt::format("{:.0f}", *value)
              : size > 0.0 && size < 1e-3 ? fmt::format("{:.{}e}", *value, digits - 1)
              : size < 1.0                ? fmt::format("{:.{}g}", *value, digits)
                           : fmt::format("{:.{}f}", *value, std::max(0, digits - before));
  return cell;
}

bool ReportTable::has_reference() const {
  return std::any_of(rows.begin(), rows.end(), [](const auto& row) {
    return std::any_of(row.begin(), row.end(),
                       [](const TableCell& c) { return !c.reference.empty(); });
  });
}

void mark_smallest(ReportTable& table) {
  for (std::vector<TableCell>& row : table.rows) {
    std::vector<TableCell*> cells;
    for (TableCell& cell : row) cells.push_back(&cell);
    mark(cells, &TableCell::best_in_row);
  }
  for (std::size_t column = 1; column < table.head.size(); ++column) {
    std::vector<TableCell*> cells;
    for (std::vector<TableCell>& row : table.rows) cells.push_back(&row.at(column));
    mark(cells, &TableCell::best_in_column);
  }
}

std::string table_html(const ReportTable& table) {
  std::string html =
      fmt::format("<div class='scroll'><table id='{}'><caption>{}</caption><thead><tr>",
                  escaped(table.id), escaped(table.title));
  for (std::size_t i = 0; i < table.head.size(); ++i) {
    const char* left = holds_words(table, i) ? " class='l'" : "";
    html += fmt::format("<th{}>{}</th>", left, escaped(table.head[i]));
  }
  html += "</tr></thead><tbody>";
  for (const auto& row : table.rows) {
    html += "<tr>";
    for (std::size_t i = 0; i < row.size(); ++i) html += html_cell(row[i], holds_words(table, i));
    html += "</tr>";
  }
  html += "</tbody></table></div>";
  if (!table.note.empty()) html += "<p class='note'>" + escaped(table.note) + "</p>";
  return html;
}

std::string table_csv(const ReportTable& table) {
  const bool reference = table.has_reference();
  std::string csv;
  for (std::size_t i = 0; i < table.head.size(); ++i) {
    if (i > 0) csv += ',';
    csv += csv_quoted(table.head[i]);
    if (reference && i > 0) csv += fmt::format(",{}", csv_quoted(table.head[i] + " (published)"));
  }
  csv += "\n";
  for (const auto& row : table.rows) {
    for (std::size_t i = 0; i < row.size(); ++i) {
      const TableCell& cell = row[i];
      if (i > 0) csv += ',';
      csv += cell.value ? fmt::format("{:.9g}", *cell.value) : csv_quoted(cell.text);
      if (reference && i > 0) csv += fmt::format(",{}", csv_quoted(cell.reference));
    }
    csv += "\n";
  }
  return csv;
}

std::string table_markdown(const ReportTable& table) {
  std::string text = "**" + table.title + "**\n\n|";
  for (const std::string& head : table.head) text += fmt::format(" {} |", head);
  text += "\n|";
  for (std::size_t i = 0; i < table.head.size(); ++i) {
    text += holds_words(table, i) ? "---|" : "---:|";
  }
  for (const auto& row : table.rows) {
    text += "\n|";
    for (const TableCell& cell : row) text += fmt::format(" {} |", markdown_cell(cell));
  }
  return text + "\n" + (table.note.empty() ? "" : "\n" + table.note + "\n");
}

std::string table_latex(const ReportTable& table) {
  std::string text = "\\begin{table}\n\\centering\n\\begin{tabular}{";
  for (std::size_t i = 0; i < table.head.size(); ++i) text += holds_words(table, i) ? 'l' : 'r';
  text += "}\n\\toprule\n";
  for (std::size_t i = 0; i < table.head.size(); ++i) {
    text += (i > 0 ? " & " : "") + latex_escaped(table.head[i]);
  }
  text += " \\\\\n\\midrule\n";
  for (const auto& row : table.rows) {
    for (std::size_t i = 0; i < row.size(); ++i) text += (i > 0 ? " & " : "") + latex_cell(row[i]);
    text += " \\\\\n";
  }
  return text + "\\bottomrule\n\\end{tabular}\n\\caption{" + latex_escaped(table.title) +
         (table.note.empty() ? "" : ". " + latex_escaped(table.note)) +
         "}\n\\label{tab:" + table.id + "}\n\\end{table}\n";
}

Json table_json(const ReportTable& table) {
  Json rows = Json::array();
  for (const auto& row : table.rows) {
    Json cells = Json::array();
    for (const TableCell& cell : row) {
      Json json{{"text", cell.text}};
      if (cell.value) json["value"] = *cell.value;
      if (!cell.reference.empty()) json["reference"] = cell.reference;
      if (cell.best_in_column) json["best_in_column"] = true;
      if (cell.best_in_row) json["best_in_row"] = true;
      cells.push_back(std::move(json));
    }
    rows.push_back(std::move(cells));
  }
  return {{"id", table.id},
          {"title", table.title},
          {"note", table.note},
          {"head", table.head},
          {"rows", rows}};
}

}  // namespace lidarena::report
