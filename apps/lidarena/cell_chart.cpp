// SPDX-License-Identifier: BSD-3-Clause
#include "apps/lidarena/cell_chart.hpp"

#include <fmt/format.h>

#include <cmath>

#include "lidarena/report/web_page.hpp"

namespace lidarena {
namespace {

constexpr double kLeft = 46.0;  // px, space for the tick labels
constexpr double kTop = 44.0;
constexpr double kTitleHeight = 20.0;
constexpr double kAxisHeight = 44.0;
constexpr double kStackedAspectRatio = 2.0;  // width / height above which panels are stacked

using report::escaped;

/// "Nice" tick positions (1, 2, 5 times a power of ten) that cover [low, high] in about `count`
/// steps.
std::vector<double> nice_ticks(double low, double high, int count) {
  const double raw = (high - low) / count;
  const double magnitude = std::pow(10.0, std::floor(std::log10(raw)));
  const double ratio = raw / magnitude;
  const double step = magnitude * (ratio < 1.5 ? 1 : ratio < 3.5 ? 2 : ratio < 7.5 ? 5 : 10);
  std::vector<double> ticks;
  // computed from whole steps, so that rounding errors do not add up
  for (auto i = static_cast<long>(std::ceil(low / step - 1e-9));; ++i) {
    const double tick = static_cast<double>(i) * step;
    if (tick > high + 1e-9 * step) return ticks;
    ticks.push_back(tick);
  }
}

/// Positions and sizes, px.
struct Layout {
  int across;  ///< panels side by side
  double px_per_deg;
  double width, height;  ///< of a panel's grid

  explicit Layout(const CellChart& chart) {
    const double span_x = chart.columns * chart.cell_deg;
    const double span_y = chart.rows * chart.cell_deg;
    across = span_x > kStackedAspectRatio * span_y ? 1 : 2;
    width = across == 1 ? 840.0 : 400.0;
    px_per_deg = width / span_x;
    height = span_y * px_per_deg;
  }
  double left(std::size_t panel) const {
    return kLeft + static_cast<double>(panel % static_cast<std::size_t>(across)) * (width + 60.0);
  }
  double top(std::size_t panel) const {
    return kTop + kTitleHeight +
           static_cast<double>(panel / static_cast<std::size_t>(across)) *
               (height + kTitleHeight + kAxisHeight);
  }
};

/// Adjacent lit cells of each row as one path, in cells from the top left corner.
std::string lit_path(const CellChart& chart, const std::vector<bool>& lit) {
  std::string path;
  for (int row = 0; row < chart.rows; ++row) {
    const auto at = [&](int from_left) {  // azimuth decreases from left to right
      return lit[static_cast<std::size_t>(row * chart.columns + chart.columns - 1 - from_left)];
    };
    for (int begin = 0; begin < chart.columns; ++begin) {
      if (!at(begin)) continue;
      int end = begin;
      while (end < chart.columns && at(end)) ++end;
      path +=
          fmt::format("M{} {}h{}v1h-{}z", begin, chart.rows - 1 - row, end - begin, end - begin);
      begin = end;
    }
  }
  return path;
}

std::string axes(const CellChart& chart, const Layout& layout) {
  const double azimuth_max = chart.azimuth_min_deg + chart.columns * chart.cell_deg;
  const double elevation_max = chart.elevation_min_deg + chart.rows * chart.cell_deg;
  std::string svg =
      fmt::format("<rect width='{:.1f}' height='{:.1f}' class='f'/>", layout.width, layout.height);
  for (const double tick : nice_ticks(chart.azimuth_min_deg, azimuth_max, 8)) {
    const double x = (azimuth_max - tick) * layout.px_per_deg;
    svg += fmt::format(
        "<path d='M{0:.1f} {1:.1f}v4' class='a'/>"
        "<text x='{0:.1f}' y='{2:.1f}' class='m'>{3:g}</text>",
        x, layout.height, layout.height + 15, tick);
  }
  for (const double tick : nice_ticks(chart.elevation_min_deg, elevation_max, 4)) {
    const double y = (elevation_max - tick) * layout.px_per_deg;
    svg += fmt::format(
        "<path d='M0 {0:.1f}h-4' class='a'/>"
        "<text x='-7' y='{1:.1f}' class='e'>{2:g}</text>",
        y, y + 4, tick);
  }
  svg += fmt::format("<text x='{:.1f}' y='{:.1f}' class='m'>azimuth, deg</text>", layout.width / 2,
                     layout.height + 29);
  return svg + fmt::format(
                   "<text transform='translate(-33 {:.1f}) rotate(-90)' class='m'>"
                   "elevation, deg</text>",
                   layout.height / 2);
}

std::string outline(const CellChart& chart, const Layout& layout) {
  const double azimuth_max = chart.azimuth_min_deg + chart.columns * chart.cell_deg;
  const double elevation_max = chart.elevation_min_deg + chart.rows * chart.cell_deg;
  std::string points;
  for (const auto& [azimuth, elevation] : chart.outline) {
    points += fmt::format("{:.1f},{:.1f} ", (azimuth_max - azimuth) * layout.px_per_deg,
                          (elevation_max - elevation) * layout.px_per_deg);
  }
  return fmt::format("<polygon points='{}' class='o'/>", points);
}

std::string panel_svg(const CellChart& chart, const Layout& layout, std::size_t i) {
  const CellPanel& panel = chart.panels[i];
  const double scale = chart.cell_deg * layout.px_per_deg;
  return fmt::format("<g transform='translate({:.1f} {:.1f})'><text y='-6' class='h'>{}</text>",
                     layout.left(i), layout.top(i), escaped(panel.title)) +
         axes(chart, layout) +
         fmt::format("<path transform='scale({:.5f})' d='{}' class='c'/>", scale,
                     lit_path(chart, panel.lit)) +
         outline(chart, layout) + "</g>";
}

}  // namespace

std::string cell_chart_svg(const CellChart& chart) {
  const Layout layout(chart);
  const std::size_t last = chart.panels.empty() ? 0 : chart.panels.size() - 1;
  const double width = kLeft + layout.across * (layout.width + 60.0) - 40.0;
  const double height = layout.top(last) + layout.height + kAxisHeight + 20.0;
  std::string svg = fmt::format(
      "<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 {0:.0f} {1:.0f}' width='{0:.0f}' "
      "height='{1:.0f}' role='img'><title>{2}</title><style>"
      "text{{font:11px sans-serif;fill:#444}}.t{{font:bold 16px sans-serif;fill:#222}}"
      ".h{{font:bold 12px sans-serif;fill:#222}}.m{{text-anchor:middle}}.e{{text-anchor:end}}"
      ".f{{fill:#f4f5f7}}.a{{stroke:#8a929c}}.c{{fill:#2b6cb0}}"
      ".o{{fill:none;stroke:#c05621;stroke-width:1.5;stroke-dasharray:6 3}}</style>"
      "<rect width='100%' height='100%' fill='#fff'/>"
      "<text x='{3}' y='20' class='t'>{2}</text><text x='{3}' y='37'>{4}</text>",
      width, height, escaped(chart.title), kLeft, escaped(chart.caption));
  for (std::size_t i = 0; i < chart.panels.size(); ++i) svg += panel_svg(chart, layout, i);
  svg += fmt::format("<path d='M{} {:.1f}h22' class='o'/><text x='{}' y='{:.1f}'>{}</text>", kLeft,
                     height - 14, kLeft + 28, height - 10, escaped(chart.outline_label));
  return svg + "</svg>\n";
}

}  // namespace lidarena
