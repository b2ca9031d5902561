// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/results/table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string_view>

namespace lidarena::results {
namespace {

std::string shown(const TableCell& cell, const char* dash) {
  return cell.text.empty() ? dash : cell.text;
}

/// " / 0.15 live", or nothing.
std::string live_of(const TableCell& cell) {
  return cell.live.empty() ? "" : " / " + cell.live + " live";
}

/// Escapes what Markdown would not show as it is, so that a command can be copied from a table.
std::string for_markdown(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (std::string_view("\\`*|<[").find(c) != std::string_view::npos) out += '\\';
    out += c == '\n' ? ' ' : c;
  }
  return out;
}

std::string for_latex(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (std::string_view("&%$#_{}").find(c) != std::string_view::npos) out += '\\';
    out += c == '\\'  ? "\\textbackslash{}"
           : c == '~' ? "\\textasciitilde{}"
           : c == '^' ? "\\textasciicircum{}"
                      : std::string(1, c);
  }
  return out;
}

/// Whether a column is aligned left: it is the first, or has words and no figure.
bool holds_words(const Table& table, std::size_t column) {
  if (column == 0) return true;
  bool words = false;
  for (const auto& row : table.rows) {
    if (column >= row.size()) continue;
    if (row[column].value) return false;
    words = words || !row[column].text.empty();
  }
  return words;
}

std::string markdown_cell(const TableCell& cell) {
  std::string text = for_markdown(shown(cell, "-"));
  if (cell.underlined) text = "<u>" + text + "</u>";
  if (cell.bold) text = "**" + text + "**";
  text += live_of(cell);
  if (!cell.spread.empty()) text += " [" + for_markdown(cell.spread) + "]";
  return cell.reference.empty() ? text : text + " (" + cell.reference + ")";
}

std::string latex_cell(const TableCell& cell) {
  std::string text = for_latex(shown(cell, "--"));
  if (cell.underlined) text = "\\underline{" + text + "}";
  if (cell.bold) text = "\\textbf{" + text + "}";
  text += live_of(cell);
  if (!cell.spread.empty()) text += " [" + for_latex(cell.spread) + "]";
  return cell.reference.empty() ? text : text + " (" + for_latex(cell.reference) + ")";
}

}  // namespace

TableCell word(std::string text) {
  TableCell cell;
  cell.text = std::move(text);
  return cell;
}

TableCell number(std::optional<double> value, int digits) {
  TableCell cell;
  if (!value || std::isnan(*value)) return cell;
  if (std::isinf(*value)) return word("lost");
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

std::string value_text(std::optional<double> value, std::optional<double> zero_bound) {
  const std::string text = number(value).text;
  return zero_bound ? fmt::format("{} (below {})", text, number(zero_bound, 2).text) : text;
}

TableCell spread_cell(const Spread& spread) {
  TableCell cell = number(spread.median);
  cell.text = value_text(spread.median, spread.zero_bound);
  const std::string range =
      spread.kept > 0 && spread.median && spread.runs > 1
          ? number(spread.best).text + " to " + number(spread.worst).text + ", "
          : "";
  if (spread.runs > 0) cell.spread = fmt::format("{}{} of {}", range, spread.kept, spread.runs);
  return cell;
}

bool Table::has(std::string TableCell::*part) const {
  return std::any_of(rows.begin(), rows.end(), [&](const auto& row) {
    return std::any_of(row.begin(), row.end(),
                       [&](const TableCell& c) { return !(c.*part).empty(); });
  });
}

std::string csv_quoted(const std::string& text) {
  if (text.find_first_of(",\"\n") == std::string::npos) return text;
  std::string out = "\"";
  for (const char c : text) out += c == '"' ? "\"\"" : std::string(1, c);
  return out + "\"";
}

std::string table_csv(const Table& table) {
  const bool reference = table.has(&TableCell::reference), spread = table.has(&TableCell::spread);
  const bool live = table.has(&TableCell::live);
  std::string csv;
  for (std::size_t i = 0; i < table.head.size(); ++i) {
    if (i > 0) csv += ',';
    csv += csv_quoted(table.head[i]);
    if (live && i > 0) csv += fmt::format(",{}", csv_quoted(table.head[i] + " (live)"));
    if (spread && i > 0) csv += fmt::format(",{}", csv_quoted(table.head[i] + " (range, runs)"));
    if (reference && i > 0) csv += fmt::format(",{}", csv_quoted(table.head[i] + " (published)"));
  }
  csv += "\n";
  for (const auto& row : table.rows) {
    for (std::size_t i = 0; i < row.size(); ++i) {
      const TableCell& cell = row[i];
      if (i > 0) csv += ',';
      csv += cell.value ? fmt::format("{:.9g}", *cell.value) : csv_quoted(cell.text);
      if (live && i > 0) csv += fmt::format(",{}", csv_quoted(cell.live));
      if (spread && i > 0) csv += fmt::format(",{}", csv_quoted(cell.spread));
      if (reference && i > 0) csv += fmt::format(",{}", csv_quoted(cell.reference));
    }
    csv += "\n";
  }
  return csv;
}

std::string table_markdown(const Table& table) {
  std::string text = (table.title.empty() ? "" : "**" + table.title + "**\n\n") + "|";
  for (const std::string& head : table.head) text += fmt::format(" {} |", head);
  text += "\n|";
  for (std::size_t i = 0; i < table.head.size(); ++i) {
    text += holds_words(table, i) ? " --- |" : " ---: |";
  }
  for (const auto& row : table.rows) {
    text += "\n|";
    for (const TableCell& cell : row) text += fmt::format(" {} |", markdown_cell(cell));
  }
  return text + "\n" + (table.note.empty() ? "" : "\n" + table.note + "\n");
}

std::string table_latex(const Table& table) {
  std::string text = "\\begin{tabular}{";
  for (std::size_t i = 0; i < table.head.size(); ++i) text += holds_words(table, i) ? 'l' : 'r';
  text += "}\n\\toprule\n";
  for (std::size_t i = 0; i < table.head.size(); ++i) {
    text += (i > 0 ? " & " : "") + for_latex(table.head[i]);
  }
  text += " \\\\\n\\midrule\n";
  for (const auto& row : table.rows) {
    for (std::size_t i = 0; i < row.size(); ++i) text += (i > 0 ? " & " : "") + latex_cell(row[i]);
    text += " \\\\\n";
  }
  text += "\\bottomrule\n\\end{tabular}\n";
  if (table.title.empty()) return text;
  return "\\begin{table}\n\\centering\n" + text + "\\caption{" + for_latex(table.title) +
         (table.note.empty() ? "" : ". " + for_latex(table.note)) + "}\n\\label{tab:" + table.id +
         "}\n\\end{table}\n";
}

std::string table_text(const Table& table) {
  const auto text_of = [](const TableCell& cell) {
    return shown(cell, "-") + live_of(cell) + (cell.spread.empty() ? "" : " [" + cell.spread + "]");
  };
  std::vector<std::size_t> widths;
  for (std::size_t i = 0; i < table.head.size(); ++i) {
    widths.push_back(table.head[i].size());
    for (const auto& row : table.rows) widths[i] = std::max(widths[i], text_of(row[i]).size());
  }
  std::string text;
  const auto add = [&](std::size_t i, const std::string& cell) {
    const bool last = i + 1 == table.head.size();
    text += last                    ? cell + "\n"
            : holds_words(table, i) ? fmt::format("{:<{}}  ", cell, widths[i])
                                    : fmt::format("{:>{}}  ", cell, widths[i]);
  };
  for (std::size_t i = 0; i < table.head.size(); ++i) add(i, table.head[i]);
  for (const auto& row : table.rows) {
    for (std::size_t i = 0; i < row.size(); ++i) add(i, text_of(row[i]));
  }
  return text;
}

}  // namespace lidarena::results
