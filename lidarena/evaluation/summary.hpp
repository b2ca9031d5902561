// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace lidarena::evaluation {

/// Statistics of a set of non-negative errors; all zero with count 0 when the set is empty.
/// Quantiles are exact (of the sorted values, linear between neighbors), sums run in index order.
struct Summary {
  std::size_t count = 0;
  double rmse = 0.0, mean = 0.0, median = 0.0, p95 = 0.0, p99 = 0.0, max = 0.0;
};
Summary summarize(std::span<const double> errors);

/// The value below which the share `p` (0..1) of `values` lies: element p (n - 1) of the sorted
/// values, linear between neighbors. Reorders `values`, which must not be empty nor hold NaN.
double quantile(std::span<double> values, double p);

}  // namespace lidarena::evaluation
