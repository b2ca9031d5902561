// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/results/stratified.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

namespace lidarena::results {
namespace {

constexpr double kInfinite = std::numeric_limits<double>::infinity();
constexpr std::size_t kExactSteps = 20'000;         // of the distribution, beyond: normal
constexpr double kNormal_97_5 = 1.959963984540054;  // quantile of the normal distribution

/// A rank with its weight as a whole number: the weight of a stratum is common / (n + 1).
struct Ranked {
  std::size_t weighted = 0;  ///< doubled, so that shared ranks are whole
  bool is_positive = false;
};

/// Ranks of the magnitudes in one stratum; equal magnitudes share their mean rank.
void add_ranks(std::vector<double> d, std::size_t weight, std::vector<Ranked>& ranks) {
  std::ranges::sort(d, {}, [](double x) { return std::abs(x); });
  for (std::size_t begin = 0, end = 0; begin < d.size(); begin = end) {
    while (end < d.size() && std::abs(d[end]) == std::abs(d[begin])) ++end;
    for (std::size_t i = begin; i < end; ++i)
      ranks.push_back({weight * (begin + 1 + end), d[i] > 0.0});
  }
}

/// The common multiple of all n + 1, as far as it stays small; 0 beyond.
std::size_t common_multiple(std::span<const std::vector<double>> strata) {
  std::size_t common = 1;
  for (const std::vector<double>& stratum : strata) {
    common = std::lcm(common, stratum.size() + 1);
    if (common > kExactSteps) return 0;
  }
  return common;
}

/// Distribution of the weighted sum of the ranks with a positive sign, when both signs are equally
/// likely.
struct Distribution {
  std::vector<double> p;  ///< of each sum; empty: normal
  double mean = 0.0, sigma = 0.0;
};

Distribution distribution_of(std::span<const Ranked> ranks, bool exact) {
  Distribution found;
  std::size_t total = 0;
  double variance = 0.0;
  for (const Ranked& rank : ranks) {
    total += rank.weighted;
    variance += 0.25 * std::pow(static_cast<double>(rank.weighted), 2);
  }
  found.mean = 0.5 * static_cast<double>(total);
  found.sigma = std::sqrt(variance);
  if (!exact || total > kExactSteps) return found;
  found.p.assign(total + 1, 0.0);
  found.p[0] = 1.0;
  for (const Ranked& rank : ranks) {
    for (std::size_t sum = total + 1; sum-- > 0;)
      found.p[sum] =
          0.5 * (found.p[sum] + (sum >= rank.weighted ? found.p[sum - rank.weighted] : 0.0));
  }
  return found;
}

double two_sided_p(const Distribution& of, std::size_t sum, double half_step) {
  if (of.p.empty()) {
    const double off = std::abs(static_cast<double>(sum) - of.mean);
    return std::erfc(std::max(0.0, off - half_step) / (std::sqrt(2.0) * of.sigma));
  }
  double below = 0.0, above = 0.0;
  for (std::size_t s = 0; s < of.p.size(); ++s) {
    if (s <= sum) below += of.p[s];
    if (s >= sum) above += of.p[s];
  }
  return std::min(1.0, 2.0 * std::min(below, above));
}

/// The largest sum whose probability, with all below it, is at most 2.5 %; empty if there is none.
std::optional<double> critical_sum(const Distribution& of) {
  if (of.p.empty()) return of.mean - kNormal_97_5 * of.sigma;
  double below = 0.0;
  for (std::size_t s = 0; s < of.p.size(); ++s) {
    below += of.p[s];
    if (below > 0.5 * kLevel)
      return s == 0 ? std::nullopt : std::optional(static_cast<double>(s - 1));
  }
  return std::nullopt;
}

using Weighted = std::pair<double, double>;  ///< value, weight

/// The means of any two of a stratum, each with itself, too. Those of +infinity and -infinity count
/// half on either side.
void add_means(const std::vector<double>& d, double weight, std::vector<Weighted>& means) {
  for (std::size_t i = 0; i < d.size(); ++i) {
    for (std::size_t k = i; k < d.size(); ++k) {
      const double mean = 0.5 * d[i] + 0.5 * d[k];
      if (!std::isnan(mean)) {
        means.emplace_back(mean, weight);
        continue;
      }
      means.emplace_back(kInfinite, 0.5 * weight);
      means.emplace_back(-kInfinite, 0.5 * weight);
    }
  }
}

/// The first value up to which the weights exceed `limit`. `means` are sorted.
double value_beyond(std::span<const Weighted> means, double limit) {
  double sum = 0.0;
  for (const auto& [value, weight] : means) {
    sum += weight;
    if (sum > limit) return value;
  }
  return means.back().first;
}

double middle_of(double a, double b) { return a == b ? a : 0.5 * a + 0.5 * b; }

/// Ratio and interval from the sorted means and the sum of weights that the test rejects below.
void estimate(std::vector<Weighted> means, std::optional<double> critical,
              StratifiedComparison& found) {
  std::ranges::sort(means);
  double total = 0.0;
  for (const auto& [value, weight] : means) total += weight;
  std::vector<Weighted> mirrored;
  for (const auto& [value, weight] : means) mirrored.emplace_back(-value, weight);
  std::ranges::reverse(mirrored);
  const double tiny = 1e-9 * total;  // of rounding
  const double low = value_beyond(means, 0.5 * total - tiny);
  const double high = -value_beyond(mirrored, 0.5 * total - tiny);
  const double middle = middle_of(low, high);
  found.ratio = std::isnan(middle) ? 1.0 : std::exp(middle);
  if (!critical) return;
  found.ratio_95 = Interval{std::exp(value_beyond(means, *critical + tiny)),
                            std::exp(-value_beyond(mirrored, *critical + tiny))};
}

/// As if no two magnitudes were equal and none zero: the sums that an interval rests on.
std::vector<Ranked> untied(std::span<const std::vector<double>> strata, std::size_t common) {
  std::vector<Ranked> ranks;
  for (const std::vector<double>& stratum : strata) {
    for (std::size_t rank = 1; rank <= stratum.size(); ++rank)
      ranks.push_back({2 * rank * (common / (stratum.size() + 1)), false});
  }
  return ranks;
}

}  // namespace

std::optional<double> log_ratio(double a, double b) {
  if (std::isnan(a) || std::isnan(b) || (std::isinf(a) && std::isinf(b))) return std::nullopt;
  if (std::isinf(b)) return b;
  if (std::isinf(a)) return -a;
  if (a < 0.0 || b < 0.0) return std::nullopt;
  return a == b ? 0.0 : std::log(b) - std::log(a);
}

StratifiedComparison compare_strata(std::span<const std::vector<double>> log_ratios) {
  StratifiedComparison found;
  std::vector<std::vector<double>> all, unequal;
  for (const std::vector<double>& stratum : log_ratios) {
    if (stratum.empty()) continue;
    found.pairs += stratum.size();
    all.push_back(stratum);
    std::vector<double> some = stratum;
    std::erase(some, 0.0);
    if (!some.empty()) unequal.push_back(std::move(some));
  }
  if (found.pairs == 0) return found;
  // without a common multiple a scale at which rounding of the weights does not matter
  const auto scale_of = [](std::span<const std::vector<double>> strata) {
    const std::size_t common = common_multiple(strata);
    return common > 0 ? common : std::size_t{1} << 32U;
  };
  if (const std::size_t common = scale_of(unequal); !unequal.empty()) {
    std::vector<Ranked> ranks;
    for (const std::vector<double>& stratum : unequal)
      add_ranks(stratum, common / (stratum.size() + 1), ranks);
    std::size_t positive = 0;
    for (const Ranked& rank : ranks) positive += rank.is_positive ? rank.weighted : 0;
    const Distribution of = distribution_of(ranks, common_multiple(unequal) > 0);
    const double step = unequal.size() > 1 ? 0.0
                                           : static_cast<double>(common) /
                                                 static_cast<double>(unequal[0].size() + 1);
    found.p = two_sided_p(of, positive, step);
    found.b_is_smaller = static_cast<double>(positive) < of.mean;
  }
  const std::size_t common = scale_of(all);
  std::vector<Weighted> means;
  for (const std::vector<double>& stratum : all)
    add_means(stratum, 2.0 * static_cast<double>(common / (stratum.size() + 1)), means);
  estimate(std::move(means),
           critical_sum(distribution_of(untied(all, common), common_multiple(all) > 0)), found);
  return found;
}

}  // namespace lidarena::results
