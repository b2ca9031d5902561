// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <span>
#include <string>

namespace lidarena::results {

/// Statistics of a set of non-negative values; all zero with count 0 when the set is empty.
/// Quantiles are exact (of the sorted values, linear between neighbors), sums run in index order.
struct Summary {
  std::size_t count = 0;
  double rmse = 0.0, mean = 0.0, median = 0.0, p95 = 0.0, p99 = 0.0, max = 0.0;
  bool empty() const { return count == 0; }
};
Summary summarize(std::span<const double> values);

/// The value below which the share `p` (0..1) of `values` lies: element p (n - 1) of the sorted
/// values, linear between neighbors. Reorders `values`, which must not be empty nor hold NaN.
double quantile(std::span<double> values, double p);

/// Least-squares line y = intercept + slope x.
struct Line {
  double slope = 0.0;
  double intercept = 0.0;
  double r_squared = 0.0;  ///< share of the variance of y that the line explains, 0..1
};
/// Both spans have the same size. A line of slope 0 through the mean with fewer than three points
/// or without any spread in x.
Line fit_line(std::span<const double> x, std::span<const double> y);

enum class Unit { kMeter, kRadian, kSecond };
constexpr const char* symbol(Unit unit) {
  return unit == Unit::kMeter ? "m" : unit == Unit::kRadian ? "rad" : "s";
}

/// A summary whose field names carry the unit of its values: "rmse_m".
template <Unit unit>
struct SummaryIn : Summary {
  SummaryIn() = default;
  SummaryIn(const Summary& summary) : Summary(summary) {}

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    const auto named = [](const char* statistic) {
      return std::string(statistic) + "_" + symbol(unit);
    };
    v("count", self.count, "", "number of values");
    v(named("rmse"), self.rmse, symbol(unit), "root mean square");
    v(named("mean"), self.mean, symbol(unit), "mean");
    v(named("median"), self.median, symbol(unit), "median");
    v(named("p95"), self.p95, symbol(unit), "95th percentile");
    v(named("p99"), self.p99, symbol(unit), "99th percentile");
    v(named("max"), self.max, symbol(unit), "maximum");
  }
};
using SummaryInMeters = SummaryIn<Unit::kMeter>;
using SummaryInRadians = SummaryIn<Unit::kRadian>;
using SummaryInSeconds = SummaryIn<Unit::kSecond>;

}  // namespace lidarena::results
