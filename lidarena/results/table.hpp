// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "lidarena/base/config_json.hpp"

namespace lidarena::results {

/// A cell of a table: a figure or a text.
struct TableCell {
  std::string text;             ///< as shown; a dash if empty
  std::optional<double> value;  ///< the unrounded figure
  std::string reference;        ///< a published figure, shown in brackets; empty = none
  bool bold = false;            ///< the table's note says what it marks
  bool underlined = false;
};

/// A cell with a text.
TableCell word(std::string text);
/// A figure with `digits` significant digits (whole numbers in full), or a dash.
TableCell number(std::optional<double> value, int digits = 3);

/// A table of CSV, JSON, Markdown and LaTeX files, of a terminal and of the report's page. The
/// first column names rows.
struct Table {
  std::string id;     ///< name of its files
  std::string title;  ///< may be empty, as the note
  std::string note;   ///< unit, what is bold
  std::vector<std::string> head;
  std::vector<std::vector<TableCell>> rows;

  bool has_reference() const;
};

/// `text` as a cell of a CSV file, quoted if necessary.
std::string csv_quoted(const std::string& text);

/// Unrounded figures; published ones, if there are any, are in separate columns.
std::string table_csv(const Table& table);
std::string table_markdown(const Table& table);
/// For the package booktabs; a tabular alone if the table has no title.
std::string table_latex(const Table& table);
/// Aligned for a terminal, without title and note.
std::string table_text(const Table& table);
Json table_json(const Table& table);

}  // namespace lidarena::results
