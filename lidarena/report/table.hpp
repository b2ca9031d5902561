// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "lidarena/base/config_json.hpp"

namespace lidarena {

/// One figure of a table, or a word.
struct TableCell {
  std::string text;             ///< as shown; empty shows a dash
  std::optional<double> value;  ///< the unrounded figure
  std::string paper;            ///< the paper's own figure, shown beside; empty = none
  bool best_in_column = false;  ///< bold: of the sensors, this one serves the algorithm best
  bool best_in_row = false;     ///< underlined: of the algorithms, this one serves the sensor best
};

TableCell word(std::string text);
/// A figure with `digits` significant digits (whole numbers in full), or a dash.
TableCell figure(std::optional<double> value, int digits = 3);

/// A table as the page, CSV, JSON, Markdown and LaTeX files show it. The first column names rows.
struct ReportTable {
  std::string id;  ///< name of its files
  std::string title;
  std::string note;  ///< unit, what is bold; may be empty
  std::vector<std::string> head;
  std::vector<std::vector<TableCell>> rows;

  bool has_paper() const;
};

/// Marks the smallest value of each column (bold) and row (underlined), where there are two or
/// more.
void mark_smallest(ReportTable& table);

std::string table_html(const ReportTable& table);
/// Unrounded figures; where the paper's stand beside ours, they have columns of their own.
std::string table_csv(const ReportTable& table);
std::string table_markdown(const ReportTable& table);
/// For the package booktabs.
std::string table_latex(const ReportTable& table);
Json table_json(const ReportTable& table);

}  // namespace lidarena
