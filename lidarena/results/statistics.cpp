// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/results/statistics.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "lidarena/base/random.hpp"
#include "lidarena/results/summary.hpp"

namespace lidarena::results {
namespace {

constexpr std::size_t kMinFlights = 3;  // of two there are only three different resamples
constexpr std::size_t kExact = 200;

/// Values of each flight, sorted by its name, so that the order of the runs does not matter.
using ByFlight = std::map<std::string, std::vector<double>>;

double median_of(std::vector<double> values) { return quantile(values, 0.5); }

std::vector<double> all_values(const ByFlight& flights) {
  std::vector<double> values;
  for (const auto& [name, some] : flights) values.insert(values.end(), some.begin(), some.end());
  return values;
}

std::optional<Interval> bootstrap_median(ByFlight flights, std::uint64_t seed,
                                         std::size_t resamples) {
  if (flights.size() < kMinFlights || resamples == 0) return std::nullopt;
  std::vector<std::vector<double>> groups;
  for (auto& [name, values] : flights) {
    std::sort(values.begin(), values.end());
    groups.push_back(std::move(values));
  }
  const CounterRandom random(seed, stream_of("bootstrap"));
  std::vector<double> medians;
  std::vector<double> drawn;
  for (std::size_t k = 0; k < resamples; ++k) {
    drawn.clear();
    for (std::size_t i = 0; i < groups.size(); ++i) {
      const double u = random.uniform(k, static_cast<std::uint32_t>(i));
      const auto& group = groups[static_cast<std::size_t>(u * static_cast<double>(groups.size()))];
      drawn.insert(drawn.end(), group.begin(), group.end());
    }
    medians.push_back(quantile(drawn, 0.5));
  }
  return Interval{quantile(medians, 0.025), quantile(medians, 0.975)};
}

std::string name_of(const RunFigure& run) {
  return run.seed.empty() ? run.flight : run.flight + " " + run.seed;
}

std::string reason_of(const RunFigure& run) {
  return run.failure.empty() ? "has no such figure" : run.failure;
}

/// Median when `failed` further values count as worse than all.
std::optional<double> median_with_failures(std::vector<double> values, std::size_t failed,
                                           Better better) {
  const std::size_t n = values.size() + failed;
  const std::size_t upper = n / 2;  // the worse of the middle ones
  if (n == 0 || upper >= values.size()) return std::nullopt;
  std::sort(values.begin(), values.end());
  if (better == Better::kMore) std::reverse(values.begin(), values.end());
  return n % 2 == 1 ? values[upper] : 0.5 * (values[upper - 1] + values[upper]);
}

/// Ranks of the magnitudes, doubled so that shared ranks are integers, and their sums.
struct SignedRanks {
  std::vector<std::size_t> doubled;
  std::size_t positive = 0;  ///< doubled sum of the ranks of positive differences
  std::size_t total = 0;     ///< of all
};

SignedRanks ranks_of(std::span<const double> differences) {
  std::vector<double> d;
  std::copy_if(differences.begin(), differences.end(), std::back_inserter(d),
               [](double x) { return x != 0.0; });
  std::sort(d.begin(), d.end(), [](double a, double b) { return std::abs(a) < std::abs(b); });
  SignedRanks ranks;
  for (std::size_t begin = 0, end = 0; begin < d.size(); begin = end) {
    while (end < d.size() && std::abs(d[end]) == std::abs(d[begin])) ++end;
    const std::size_t doubled = begin + 1 + end;  // twice the mean of begin + 1 .. end
    for (std::size_t i = begin; i < end; ++i) {
      ranks.doubled.push_back(doubled);
      ranks.total += doubled;
      if (d[i] > 0.0) ranks.positive += doubled;
    }
  }
  return ranks;
}

/// Probability of each doubled rank sum when both signs are equally likely.
std::vector<double> distribution_of(const SignedRanks& ranks) {
  std::vector<double> p(ranks.total + 1, 0.0);
  p[0] = 1.0;
  for (const std::size_t rank : ranks.doubled) {
    for (std::size_t sum = p.size(); sum-- > 0;) {
      p[sum] = 0.5 * (p[sum] + (sum >= rank ? p[sum - rank] : 0.0));
    }
  }
  return p;
}

double exact_p(const SignedRanks& ranks) {
  const std::vector<double> p = distribution_of(ranks);
  double below = 0.0;
  double above = 0.0;
  for (std::size_t sum = 0; sum < p.size(); ++sum) {
    if (sum <= ranks.positive) below += p[sum];
    if (sum >= ranks.positive) above += p[sum];
  }
  return std::min(1.0, 2.0 * std::min(below, above));
}

/// Normal approximation with the variance for shared ranks and a continuity correction of half a
/// rank.
double normal_p(const SignedRanks& ranks) {
  double variance = 0.0;
  for (const std::size_t doubled : ranks.doubled) {
    variance += std::pow(0.25 * static_cast<double>(doubled), 2);
  }
  const double w = 0.5 * static_cast<double>(ranks.positive);
  const double off = std::abs(w - 0.25 * static_cast<double>(ranks.total));
  return std::erfc(std::max(0.0, off - 0.5) / std::sqrt(2.0 * variance));
}

}  // namespace

Spread spread_of(std::span<const RunFigure> runs, std::uint64_t seed, std::size_t resamples,
                 Better better) {
  Spread spread;
  spread.runs = runs.size();
  ByFlight flights;
  for (const RunFigure& run : runs) {
    if (run.value) {
      flights[run.flight].push_back(*run.value);
    } else {
      spread.failures.push_back(name_of(run) + ": " + reason_of(run));
    }
  }
  std::vector<double> values = all_values(flights);
  spread.values = values.size();
  spread.flights = flights.size();
  spread.median_with_failures = median_with_failures(values, spread.failures.size(), better);
  if (values.empty()) return spread;
  std::sort(values.begin(), values.end());
  for (const double value : values) spread.mean += value / static_cast<double>(values.size());
  spread.min = values.front();
  spread.max = values.back();
  spread.median = quantile(values, 0.5);
  spread.median_95 = bootstrap_median(std::move(flights), seed, resamples);
  return spread;
}

PairedComparison compare_paired(std::span<const RunFigure> a, std::span<const RunFigure> b,
                                std::uint64_t seed, std::size_t resamples) {
  std::map<std::pair<std::string, std::string>, const RunFigure*> others;
  for (const RunFigure& run : b) others[{run.flight, run.seed}] = &run;
  PairedComparison found;
  ByFlight flights;
  for (const RunFigure& run : a) {
    const auto other = others.find({run.flight, run.seed});
    const bool there = other != others.end();
    if (!run.value || !there || !other->second->value) {
      found.missing.push_back(fmt::format(
          "{}: {}", name_of(run),
          !run.value ? "a: " + reason_of(run)
                     : "b: " + (there ? reason_of(*other->second) : std::string("was not run"))));
    } else {
      flights[run.flight].push_back(*other->second->value - *run.value);
    }
    if (there) others.erase(other);
  }
  for (const auto& [key, run] : others) found.missing.push_back(name_of(*run) + ": a: was not run");
  const std::vector<double> differences = all_values(flights);
  found.pairs = differences.size();
  for (const double d : differences) {
    ++(d < 0.0 ? found.b_smaller : d > 0.0 ? found.a_smaller : found.ties);
  }
  if (differences.empty()) return found;
  found.median_difference = median_of(differences);
  found.difference_95 = bootstrap_median(std::move(flights), seed, resamples);
  found.wilcoxon_p = wilcoxon_signed_rank_p(differences);
  return found;
}

std::optional<double> wilcoxon_signed_rank_p(std::span<const double> differences) {
  const SignedRanks ranks = ranks_of(differences);
  if (ranks.doubled.empty()) return std::nullopt;
  return ranks.doubled.size() <= kExact ? exact_p(ranks) : normal_p(ranks);
}

}  // namespace lidarena::results
