// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "lidarena/base/config_json.hpp"
#include "lidarena/results/statistics.hpp"

namespace lidarena::results {

/// A cell of a table: a figure or a text.
struct TableCell {
  static constexpr const char* kTitle = "Cell";
  static constexpr bool kOmitsDefaults = true;
  std::string text;             ///< as shown; a dash if empty
  std::optional<double> value;  ///< the unrounded figure
  std::string live;             ///< the figure as known at each scan, beside the final one
  std::string spread;           ///< range and runs of a median: "1.1 to 1.4, 8 of 8"
  std::string reference;        ///< a published figure, shown in brackets; empty = none
  bool bold = false;            ///< the table's note says what it marks
  bool underlined = false;

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("text", self.text, "", "as shown");
    v("value", self.value, "", "not rounded");
    v("live", self.live, "", "the figure as known at each scan");
    v("spread", self.spread, "", "range and runs of a median");
    v("reference", self.reference, "", "a published figure");
    v("bold", self.bold, "", "");
    v("underlined", self.underlined, "", "");
  }
};

/// A cell with a text.
TableCell word(std::string text);
/// A figure with `digits` significant digits (whole numbers in full), "lost" if it is infinite
/// (that of a lost run), or a dash.
TableCell number(std::optional<double> value, int digits = 3);
/// The same as text; a share of zero with its upper bound (see zero_bound()): "0 (below 0.003)".
std::string value_text(std::optional<double> value, std::optional<double> zero_bound);
/// Median, range from the best to the worst, and how many runs were kept: "1.2", "1.1 to lost, 7 of
/// 8".
TableCell spread_cell(const Spread& spread);

/// A table of CSV, JSON, Markdown and LaTeX files, of a terminal and of the report's page. The
/// first column names rows.
struct Table {
  static constexpr const char* kTitle = "Table";
  std::string id;     ///< name of its files
  std::string title;  ///< may be empty, as the note
  std::string note;   ///< unit, what is bold
  std::vector<std::string> head;
  std::vector<std::vector<TableCell>> rows;

  /// Whether some cell has this part.
  bool has(std::string TableCell::*part) const;

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("id", self.id, "", "name of its files");
    v("title", self.title, "", "");
    v("note", self.note, "", "");
    v("head", self.head, "", "");
    v("rows", self.rows, "", "");
  }
};

/// `text` as a cell of a CSV file, quoted if necessary.
std::string csv_quoted(const std::string& text);

/// Unrounded figures; spreads and published figures, if there are any, are in separate columns.
std::string table_csv(const Table& table);
std::string table_markdown(const Table& table);
/// For the package booktabs; a tabular alone if the table has no title.
std::string table_latex(const Table& table);
/// Aligned for a terminal, without title and note.
std::string table_text(const Table& table);

}  // namespace lidarena::results
