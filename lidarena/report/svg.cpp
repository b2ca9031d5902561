// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/report/svg.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace lidarena {
namespace {

constexpr const char* kGrid = "#e3e6ea";
constexpr const char* kAxis = "#8a929c";

/// Maps data to pixels inside a frame and draws the frame.
struct Frame {
  double left, top, width, height;
  double x0, x1, y0, y1;

  double px(double x) const { return left + (x - x0) / (x1 - x0) * width; }
  double py(double y) const { return top + height - (y - y0) / (y1 - y0) * height; }

  std::string grid(const std::vector<double>& xs, const std::vector<double>& ys) const {
    std::string svg;
    for (const double y : ys) {
      svg += fmt::format(
          "<line x1='{:.1f}' x2='{:.1f}' y1='{:.1f}' y2='{:.1f}' stroke='{}'/>"
          "<text x='{:.1f}' y='{:.1f}' class='t' text-anchor='end'>{:g}</text>",
          left, left + width, py(y), py(y), kGrid, left - 5, py(y) + 3.5, y);
    }
    for (const double x : xs) {
      svg += fmt::format("<text x='{:.1f}' y='{:.1f}' class='t' text-anchor='middle'>{:g}</text>",
                         px(x), top + height + 14, x);
    }
    svg += fmt::format("<line x1='{:.1f}' x2='{:.1f}' y1='{:.1f}' y2='{:.1f}' stroke='{}'/>", left,
                       left + width, top + height, top + height, kAxis);
    return svg;
  }
};

constexpr int kLegendRow = 14;     // px
constexpr double kChartLeft = 48;  // px, room for the tick labels

double legend_width(const Series& series) {
  return 26.0 + 6.2 * static_cast<double>(series.name.size());
}

/// Where each entry of the legend goes: (x from the left, row).
std::vector<std::pair<double, int>> legend_places(const LineChart& chart) {
  std::vector<std::pair<double, int>> places;
  double x = kChartLeft;
  int row = 0;
  for (const Series& s : chart.series) {
    if (x > kChartLeft && x + legend_width(s) > chart.width) {
      x = kChartLeft;
      ++row;
    }
    places.emplace_back(x, row);
    x += legend_width(s);
  }
  return places;
}

int legend_rows(const LineChart& chart) {
  const auto places = legend_places(chart);
  return places.empty() ? 1 : places.back().second + 1;
}

std::string legend(const LineChart& chart) {
  std::string svg;
  const auto places = legend_places(chart);
  for (std::size_t i = 0; i < places.size(); ++i) {
    const auto [x, row] = places[i];
    const int y = chart.height - 5 + kLegendRow * row;
    svg += fmt::format(
        "<rect x='{:.1f}' y='{}' width='10' height='3' fill='{}'/>"
        "<text x='{:.1f}' y='{}' class='t'>{}</text>",
        x, y - 4, chart.series[i].color, x + 14, y, escaped(chart.series[i].name));
  }
  return svg;
}

std::string open_svg(int width, int height, const std::string& title) {
  return fmt::format(
      "<svg viewBox='0 0 {0} {1}' width='{0}' height='{1}' role='img' aria-label='{2}'>"
      "<text x='8' y='15' class='h'>{2}</text>",
      width, height, escaped(title));
}

}  // namespace

std::string escaped(std::string_view text) {
  std::string out;
  for (const char c : text) {
    switch (c) {
      case '&':
        out += "&amp;";
        break;
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '"':
        out += "&quot;";
        break;
      case '\'':
        out += "&#39;";
        break;
      default:
        out += c;
    }
  }
  return out;
}

std::vector<double> nice_ticks(double low, double high, int count) {
  if (!(high > low) || count < 1) return {low};
  const double raw = (high - low) / count;
  const double magnitude = std::pow(10.0, std::floor(std::log10(raw)));
  const double ratio = raw / magnitude;
  const double step = magnitude * (ratio < 1.5 ? 1 : ratio < 3.5 ? 2 : ratio < 7.5 ? 5 : 10);
  std::vector<double> ticks;
  // counted in whole steps, so that rounding does not add up
  for (auto i = static_cast<long>(std::ceil(low / step - 1e-9));; ++i) {
    const double tick = static_cast<double>(i) * step;
    if (tick > high + 1e-9 * step) return ticks;
    ticks.push_back(tick);
  }
}

std::string histogram_svg(const HistogramPanel& panel) {
  constexpr int kWidth = 330;
  constexpr int kHeight = 214;
  const double range_cm = panel.bin_cm * static_cast<double>(panel.percent.size());
  const double overflow_cm = 2.0 * panel.bin_cm;  // width of the bin beyond the threshold
  const Frame frame{
      36, 26, kWidth - 46, kHeight - 92, 0, range_cm + overflow_cm, 0, panel.y_max_percent};
  std::string svg = open_svg(kWidth, kHeight, panel.title);
  svg += frame.grid(nice_ticks(0, range_cm, 4), nice_ticks(0, panel.y_max_percent, 4));
  const auto bar = [&](double from_cm, double width_cm, double percent, const std::string& fill) {
    const double y = frame.py(std::min(percent, panel.y_max_percent));
    svg += fmt::format("<rect x='{:.1f}' y='{:.1f}' width='{:.1f}' height='{:.1f}' fill='{}'/>",
                       frame.px(from_cm) + 0.5, y, frame.px(width_cm) - frame.px(0) - 1.0,
                       frame.top + frame.height - y, fill);
  };
  for (std::size_t i = 0; i < panel.percent.size(); ++i) {
    bar(panel.bin_cm * static_cast<double>(i), panel.bin_cm, panel.percent[i], panel.color);
  }
  bar(range_cm, overflow_cm, panel.outliers_percent, "url(#hatch)");
  svg += fmt::format(
      "<line x1='{0:.1f}' x2='{0:.1f}' y1='{1}' y2='{2}' stroke='#e0a800' stroke-width='2'/>",
      frame.px(range_cm), frame.top, frame.top + frame.height);
  if (panel.rmse_cm > 0 && panel.rmse_cm < range_cm) {
    svg += fmt::format(
        "<line x1='{0:.1f}' x2='{0:.1f}' y1='{1}' y2='{2}' stroke='#222' stroke-dasharray='3 3'/>"
        "<text x='{3:.1f}' y='{4}' class='t'>RMSE</text>",
        frame.px(panel.rmse_cm), frame.top, frame.top + frame.height, frame.px(panel.rmse_cm) + 4,
        frame.top + 9);
  }
  svg += fmt::format(
      "<text x='{:.1f}' y='{:.1f}' class='t' text-anchor='middle'>point-to-mesh distance, cm "
      "(hatched: beyond 20)</text>",
      frame.left + frame.width / 2, frame.top + frame.height + 28);
  double y = kHeight - 20;
  for (const std::string& line : panel.caption) {
    svg += fmt::format("<text x='8' y='{}' class='t'>{}</text>", y, escaped(line));
    y += 13;
  }
  return svg + "</svg>";
}

std::string line_chart_svg(const LineChart& chart) {
  double x0 = std::numeric_limits<double>::infinity();
  double x1 = -x0;
  double y0 = chart.y_from_zero ? 0.0 : x0;
  double y1 = -std::numeric_limits<double>::infinity();
  for (const Series& s : chart.series) {
    for (std::size_t i = 0; i < s.x.size(); ++i) {
      if (!std::isfinite(s.x[i]) || !std::isfinite(s.y[i])) continue;
      x0 = std::min(x0, s.x[i]);
      x1 = std::max(x1, s.x[i]);
      y0 = std::min(y0, s.y[i]);
      y1 = std::max(y1, s.y[i]);
    }
  }
  std::string svg =
      open_svg(chart.width, chart.height + kLegendRow * (legend_rows(chart) - 1), chart.title);
  if (!(x1 > x0)) return svg + "<text x='8' y='40' class='t'>no data</text></svg>";
  if (!(y1 > y0)) y1 = y0 + 1.0;
  const Frame frame{kChartLeft, 26, chart.width - 60.0,   chart.height - 80.0, x0,
                    x1,         y0, y1 + 0.05 * (y1 - y0)};
  svg += frame.grid(nice_ticks(x0, x1, 6), nice_ticks(y0, y1, 4));
  for (const Series& s : chart.series) {
    std::string path;
    bool pen_down = false;
    for (std::size_t i = 0; i < s.x.size(); ++i) {
      if (!std::isfinite(s.x[i]) || !std::isfinite(s.y[i])) {
        pen_down = false;
        continue;
      }
      path +=
          fmt::format("{}{:.1f} {:.1f}", pen_down ? "L" : "M", frame.px(s.x[i]), frame.py(s.y[i]));
      pen_down = true;
    }
    svg += fmt::format("<path d='{}' fill='none' stroke='{}' stroke-width='1.4'/>", path, s.color);
  }
  svg += fmt::format("<text x='{:.1f}' y='{}' class='t' text-anchor='middle'>{}</text>",
                     frame.left + frame.width / 2, chart.height - 25, escaped(chart.x_label));
  svg += fmt::format("<text x='{}' y='{}' class='t' text-anchor='end'>{}</text>", chart.width - 10,
                     15, escaped(chart.y_label));
  svg += legend(chart);
  return svg + "</svg>";
}

}  // namespace lidarena
