// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace lidarena {

/// Text made safe for HTML and SVG.
std::string escaped(std::string_view text);

/// "Nice" tick positions (1, 2, 5 times a power of ten) that cover [low, high] in about `count`
/// steps.
std::vector<double> nice_ticks(double low, double high, int count);

/// Share of points by point-to-mesh distance: fixed bins over 0..20 cm and one hatched bin for all
/// beyond, with the threshold and the RMSE marked. Every panel of a report shares the same axes.
struct HistogramPanel {
  std::string title;
  std::vector<double> percent;  ///< one a bin of `bin_cm`
  double bin_cm = 1.0;
  double outliers_percent = 0.0;
  double rmse_cm = 0.0;
  double y_max_percent = 100.0;      ///< the same in all panels
  std::vector<std::string> caption;  ///< two lines
  std::string color = "#2b6cb0";
};
std::string histogram_svg(const HistogramPanel& panel);

/// One curve of a line chart.
struct Series {
  std::string name;
  std::string color;
  std::vector<double> x, y;  ///< of equal length; a NaN breaks the line
};
struct LineChart {
  std::string title, x_label, y_label;
  std::vector<Series> series;
  int width = 520;
  int height = 220;
  bool y_from_zero = true;
};
std::string line_chart_svg(const LineChart& chart);

}  // namespace lidarena
