// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "lidarena/base/config_json.hpp"

namespace lidarena::report {

/// A cell of a table: a figure or a text.
struct TableCell {
  std::string text;             ///< as shown; a dash if empty
  std::optional<double> value;  ///< the unrounded figure
  std::string reference;        ///< a published figure, shown in brackets; empty = none
  bool best_in_column = false;  ///< bold: the best sensor for this algorithm
  bool best_in_row = false;     ///< underlined: the best algorithm for this sensor
};

/// A cell with a text.
TableCell word(std::string text);
/// A figure with `digits` significant digits (whole numbers in full), or a dash.
TableCell figure(std::optional<double> value, int digits = 3);

/// A table of the page and of the CSV, JSON, Markdown and LaTeX files. The first column names rows.
struct ReportTable {
  std::string id;  ///< name of its files
  std::string title;
  std::string note;  ///< unit, what is bold; may be empty
  std::vector<std::string> head;
  std::vector<std::vector<TableCell>> rows;

  bool has_reference() const;
};

/// Marks the smallest value of each column (bold) and row (underlined), where there are two or
/// more.
void mark_smallest(ReportTable& table);

std::string table_html(const ReportTable& table);
/// Unrounded figures; published ones, if there are any, are in separate columns.
std::string table_csv(const ReportTable& table);
std::string table_markdown(const ReportTable& table);
/// For the package booktabs.
std::string table_latex(const ReportTable& table);
Json table_json(const ReportTable& table);

}  // namespace lidarena::report
