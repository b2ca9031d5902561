// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/results/table.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

namespace lidarena::results {
namespace {

using ::testing::HasSubstr;

Table small_table() {
  Table table{"t", "A & B <i>", "", {"sensor", "x_1", "y"}, {}};
  table.rows = {{word("a,b"), number(1.2345), number(0.00059)}, {word("c"), number(7), word("")}};
  table.rows[0][1].reference = "1.08";
  table.rows[0][1].bold = true;
  table.rows[0][2].underlined = true;
  return table;
}

TEST(Table, EachFormatHasTheFiguresTheMarksAndThePapers) {
  const Table table = small_table();
  EXPECT_EQ(table_csv(table),
            "sensor,x_1,x_1 (published),y,y (published)\n\"a,b\",1.2345,1.08,0.00059,\nc,7,,,\n");
  EXPECT_THAT(table_markdown(table), HasSubstr("| a,b | **1.23** (1.08) | <u>5.90e-04</u> |"));
  EXPECT_THAT(table_latex(table), HasSubstr("\\textbf{1.23} (1.08) & \\underline{5.90e-04} \\\\"));
  EXPECT_EQ(table_text(table), "sensor   x_1  y\na,b     1.23  5.90e-04\nc          7  -\n");
  Table with_interval = table;
  with_interval.rows[1][1].spread = "5 to 9";
  EXPECT_THAT(table_text(with_interval), HasSubstr("c       7 [5 to 9]  -"));
  EXPECT_THAT(table_latex(table), HasSubstr("sensor & x\\_1 & y"));
  EXPECT_EQ(lidarena::to_json(table).at("rows").at(0).at(1).at("value"), 1.2345);
}

TEST(Table, ACellOfRunsHasItsRangeAndHowManyWereKept) {
  Spread spread;
  spread.runs = spread.kept = 8;
  spread.median = 1.234;
  spread.best = 1.0;
  spread.worst = 1.5;
  EXPECT_EQ(spread_cell(spread).text, "1.23");
  EXPECT_EQ(spread_cell(spread).spread, "1 to 1.50, 8 of 8");
  spread.kept = 7;
  spread.worst = std::numeric_limits<double>::infinity();
  EXPECT_EQ(spread_cell(spread).spread, "1 to lost, 7 of 8");
  spread.kept = 3;
  spread.median = spread.worst;
  EXPECT_EQ(spread_cell(spread).text, "lost");
  EXPECT_FALSE(spread_cell(spread).value);
  spread.median = spread.best = spread.worst = 0.0;
  spread.zero_bound = 0.0015;
  EXPECT_EQ(spread_cell(spread).text, "0 (below 0.0015)");
  const Table table{"", "", "", {"sensor", "x"}, {{word("os0"), spread_cell(spread)}}};
  EXPECT_EQ(table_csv(table), "sensor,x,\"x (range, runs)\"\nos0,0,\"0 to 0, 3 of 8\"\n");
  EXPECT_THAT(table_markdown(table), HasSubstr("| 0 (below 0.0015) [0 to 0, 3 of 8] |"));
}

TEST(Table, WhatAFormatReservesIsEscaped) {
  Table table{
      "", "", "", {"run", "50 % & more"}, {{word("a|b_c"), word("x^~\\")}, {word("`a*`<[")}}};
  EXPECT_THAT(table_markdown(table), HasSubstr("| a\\|b_c | x^~\\\\ |"));
  EXPECT_THAT(table_markdown(table), HasSubstr("| \\`a\\*\\`\\<\\[ |"));
  EXPECT_THAT(table_latex(table), HasSubstr("run & 50 \\% \\& more \\\\"));
  EXPECT_THAT(table_latex(table),
              HasSubstr("a|b\\_c & x\\textasciicircum{}\\textasciitilde{}\\textbackslash{}"));
}

}  // namespace
}  // namespace lidarena::results
