// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/evaluation/map/signed_distance.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "lidarena/results/summary.hpp"

namespace lidarena::evaluation {
namespace {

void count(double value, SignedHistogram& histogram) {
  if (value < -SignedHistogram::kRange_m) {
    ++histogram.below;
  } else if (value > SignedHistogram::kRange_m) {
    ++histogram.above;
  } else {
    const double bin = (value + SignedHistogram::kRange_m) / SignedHistogram::kBin_m;
    ++histogram.counts[std::min(static_cast<std::size_t>(bin), SignedHistogram::kBins - 1)];
  }
}

}  // namespace

SignedDistance signed_distance(std::span<const PointScore> scores,
                               std::span<const FreeSide> free_side) {
  SignedDistance result;
  std::vector<double> values;
  for (const PointScore& score : scores) {
    const double height = score.height;
    const auto side = static_cast<double>(free_side[score.triangle]);
    if (side == 0.0 || std::abs(height) < SignedDistance::kMinCosine * score.distance) {
      ++result.without;
      continue;
    }
    values.push_back(std::copysign(score.distance, side * height));
    count(values.back(), result.histogram);
  }
  result.points = values.size();
  if (values.empty()) return result;
  const auto n = static_cast<double>(values.size());
  result.mean_m = std::accumulate(values.begin(), values.end(), 0.0) / n;
  const auto behind = std::count_if(values.begin(), values.end(), [](double v) { return v < 0; });
  result.behind_percent = 100.0 * static_cast<double>(behind) / n;
  result.median_m = results::quantile(values, 0.5);
  result.p5_m = results::quantile(values, 0.05);
  result.p95_m = results::quantile(values, 0.95);
  return result;
}

}  // namespace lidarena::evaluation
