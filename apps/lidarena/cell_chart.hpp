// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace lidarena {

/// A grid of square cells over directions; lit cells (those that a shot has hit) are filled.
struct CellPanel {
  std::string title;
  std::vector<bool> lit;  ///< rows from the lowest elevation, each from the lowest azimuth
};

/// Panels with the same grid, as seen from the sensor: positive azimuths on the left.
struct CellChart {
  std::string title;
  std::string caption;
  double azimuth_min_deg = -180.0;
  double elevation_min_deg = -90.0;
  double cell_deg = 1.0;
  int columns = 360;
  int rows = 180;
  std::vector<CellPanel> panels;
  std::vector<std::pair<double, double>> outline;  ///< closed polygon of azimuth and elevation, deg
  std::string outline_label;
};

/// A self-contained SVG document.
std::string cell_chart_svg(const CellChart& chart);

}  // namespace lidarena
