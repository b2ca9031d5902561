// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/results/statistics.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <utility>

#include "lidarena/base/random.hpp"
#include "lidarena/results/summary.hpp"

namespace lidarena::results {
namespace {

constexpr std::size_t kExact = 50;

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
  if (flights.size() < kMinFlightsOfInterval || resamples == 0) return std::nullopt;
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

bool Spread::is_lost() const { return median && std::isinf(*median); }

Spread spread_of(std::span<const RunFigure> runs, Better better, std::uint64_t seed,
                 std::size_t resamples) {
  Spread spread;
  spread.runs = runs.size();
  ByFlight flights;
  std::size_t known = 0;  // of the runs that are kept
  for (const RunFigure& run : runs) {
    const bool lost = run.value && std::isinf(*run.value);
    spread.kept += lost ? 0 : 1;
    if (!run.failure.empty()) spread.failures.push_back(name_of(run) + ": " + run.failure);
    if (!run.value) continue;
    flights[run.flight].push_back(*run.value);
    known += lost ? 0 : 1;
  }
  if (flights.empty() || (spread.kept > 0 && known == 0)) return spread;
  const std::vector<double> values = all_values(flights);
  const auto [smallest, largest] = std::ranges::minmax(values);
  spread.flights = flights.size();
  spread.best = better == Better::kLess ? smallest : largest;
  spread.worst = better == Better::kLess ? largest : smallest;
  spread.median = median_of(values);
  if (spread.median == 0.0)
    for (const RunFigure& run : runs)
      spread.zero_bound = std::max(spread.zero_bound, run.zero_bound);
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
      found.missing.push_back(fmt::format("{}: {}", name_of(run),
                                          !there       ? "b: was not run"
                                          : !run.value ? "a: has no such figure"
                                                       : "b: has no such figure"));
    } else if (std::isinf(*run.value) && std::isinf(*other->second->value)) {
      found.missing.push_back(name_of(run) + ": lost with both");
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

std::vector<double> holm(std::span<const double> p) {
  std::vector<std::size_t> order(p.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::sort(order, {}, [&](std::size_t i) { return p[i]; });
  std::vector<double> corrected(p.size());
  double largest = 0.0;
  for (std::size_t k = 0; k < order.size(); ++k) {
    largest = std::max(largest, std::min(1.0, p[order[k]] * static_cast<double>(p.size() - k)));
    corrected[order[k]] = largest;
  }
  return corrected;
}

}  // namespace lidarena::results
