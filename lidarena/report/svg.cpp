// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/report/svg.hpp"

#include <cmath>

namespace lidarena::report {

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
  // computed from whole steps, so that rounding errors do not add up
  for (auto i = static_cast<long>(std::ceil(low / step - 1e-9));; ++i) {
    const double tick = static_cast<double>(i) * step;
    if (tick > high + 1e-9 * step) return ticks;
    ticks.push_back(tick);
  }
}

}  // namespace lidarena::report
