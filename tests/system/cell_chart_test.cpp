// SPDX-License-Identifier: BSD-3-Clause
#include "apps/lidarena/cell_chart.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace lidarena {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

/// Three columns from -1.5 to 1.5 deg, two rows from 0 to 2 deg.
CellChart small_chart(std::vector<bool> lit) {
  return {.title = "a < b",
          .caption = "cells",
          .azimuth_min_deg = -1.5,
          .elevation_min_deg = 0.0,
          .cell_deg = 1.0,
          .columns = 3,
          .rows = 2,
          .panels = {{"0.1 s: 50 % lit", std::move(lit)}},
          .outline = {{-1.5, 0}, {1.5, 0}, {1.5, 2}, {-1.5, 2}},
          .outline_label = "field of view"};
}

TEST(CellChart, DrawsWhatTheSensorSeesWithTheLeftOnTheLeftAndUpUpwards) {
  // Lit: the two leftmost cells (highest azimuths) of the lower row, the rightmost of the upper
  // one.
  const std::string svg = cell_chart_svg(small_chart({false, true, true, true, false, false}));
  EXPECT_THAT(svg, HasSubstr("d='M0 1h2v1h-2zM2 0h1v1h-1z'"));
}

TEST(CellChart, IsASelfContainedDocumentWithTitlesAxesAndTheOutline) {
  CellChart chart = small_chart(std::vector<bool>(6, false));
  chart.panels.push_back({"4 s: 100 % lit", std::vector<bool>(6, true)});
  const std::string svg = cell_chart_svg(chart);
  EXPECT_EQ(svg.rfind("<svg xmlns='http://www.w3.org/2000/svg'", 0), 0U);
  EXPECT_THAT(svg, HasSubstr("a &lt; b"));
  EXPECT_THAT(svg, HasSubstr("0.1 s: 50 % lit"));
  EXPECT_THAT(svg, HasSubstr("4 s: 100 % lit"));
  EXPECT_THAT(svg, HasSubstr("azimuth, deg"));
  EXPECT_THAT(svg, HasSubstr("elevation, deg"));
  EXPECT_THAT(svg, HasSubstr("<polygon"));
  EXPECT_THAT(svg, HasSubstr("field of view"));
  EXPECT_THAT(svg, Not(HasSubstr("href")));
}

}  // namespace
}  // namespace lidarena
