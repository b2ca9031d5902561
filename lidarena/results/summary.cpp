// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/results/summary.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace lidarena::results {

namespace {

/// As quantile(), where the first `ordered` values are no larger than the others and the quantile
/// lies among these. Afterwards `ordered` says the same for any larger quantile.
double quantile_beyond(std::span<double> values, double p, std::size_t& ordered) {
  const double rank = p * static_cast<double>(values.size() - 1);
  const auto below = static_cast<std::size_t>(rank);
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(below);
  std::nth_element(values.begin() + static_cast<std::ptrdiff_t>(ordered), at, values.end());
  ordered = below;
  const double low = *at, part = rank - static_cast<double>(below);
  if (part == 0.0 || std::isinf(low)) return low;  // between infinite values nothing is linear
  const double high = *std::min_element(at + 1, values.end());
  return low + part * (high - low);
}

}  // namespace

double quantile(std::span<double> values, double p) {
  std::size_t ordered = 0;
  return quantile_beyond(values, p, ordered);
}

Summary summarize(std::span<const double> values) {
  Summary summary;
  summary.count = values.size();
  if (values.empty()) return summary;
  double sum = 0.0;
  double sum_of_squares = 0.0;
  for (const double value : values) {
    sum += value;
    sum_of_squares += value * value;
  }
  const auto n = static_cast<double>(values.size());
  summary.mean = sum / n;
  summary.rmse = std::sqrt(sum_of_squares / n);
  std::vector<double> reordered(values.begin(), values.end());
  std::size_t ordered = 0;
  summary.median = quantile_beyond(reordered, 0.5, ordered);
  summary.p95 = quantile_beyond(reordered, 0.95, ordered);
  summary.p99 = quantile_beyond(reordered, 0.99, ordered);
  summary.max =
      *std::max_element(reordered.begin() + static_cast<std::ptrdiff_t>(ordered), reordered.end());
  return summary;
}

Line fit_line(std::span<const double> x, std::span<const double> y) {
  Line line;
  if (x.size() < 3) return line;
  const auto n = static_cast<double>(x.size());
  double x_mean = 0.0;
  double y_mean = 0.0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    x_mean += x[i] / n;
    y_mean += y[i] / n;
  }
  double xx = 0.0;
  double xy = 0.0;
  double yy = 0.0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double dx = x[i] - x_mean;
    const double dy = y[i] - y_mean;
    xx += dx * dx;
    xy += dx * dy;
    yy += dy * dy;
  }
  line.intercept = y_mean;
  if (!(xx > 0.0)) return line;
  line.slope = xy / xx;
  line.intercept = y_mean - line.slope * x_mean;
  line.r_squared = yy > 0.0 ? xy * xy / (xx * yy) : 0.0;
  return line;
}

}  // namespace lidarena::results
