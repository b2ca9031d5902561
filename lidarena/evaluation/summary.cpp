// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/evaluation/summary.hpp"

#include <algorithm>
#include <cmath>

namespace lidarena::evaluation {

double quantile(std::span<double> values, double p) {
  const double rank = p * static_cast<double>(values.size() - 1);
  const auto below = static_cast<std::ptrdiff_t>(rank);
  const auto at = values.begin() + below;
  std::nth_element(values.begin(), at, values.end());
  const double low = *at;
  if (at + 1 == values.end()) return low;
  const double high = *std::min_element(at + 1, values.end());
  return low + (rank - static_cast<double>(below)) * (high - low);
}

Summary summarize(std::span<const double> errors) {
  Summary summary;
  summary.count = errors.size();
  if (errors.empty()) return summary;
  double sum = 0.0;
  double sum_of_squares = 0.0;
  for (const double error : errors) {
    sum += error;
    sum_of_squares += error * error;
  }
  const auto n = static_cast<double>(errors.size());
  summary.mean = sum / n;
  summary.rmse = std::sqrt(sum_of_squares / n);
  std::vector<double> values(errors.begin(), errors.end());
  summary.median = quantile(values, 0.5);
  summary.p95 = quantile(values, 0.95);
  summary.p99 = quantile(values, 0.99);
  summary.max = *std::max_element(values.begin(), values.end());
  return summary;
}

}  // namespace lidarena::evaluation
