// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/results/contributions.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <map>
#include <set>

#include "lidarena/base/random.hpp"
#include "lidarena/results/lost.hpp"
#include "lidarena/results/summary.hpp"

namespace lidarena::results {
namespace {

constexpr std::size_t kMaxParts = 10;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Figures of one combination by flight and seed.
using Values = std::map<std::string, double>;

/// The names of what is changed, in the order of the runs.
std::vector<std::string> parts_of(const std::vector<RunRecord>& runs) {
  std::vector<std::string> names;
  for (const RunRecord& run : runs) {
    for (const std::string& name : run.differs)
      if (std::ranges::find(names, name) == names.end()) names.push_back(name);
  }
  return names;
}

std::size_t combination_of(const RunRecord& run, const std::vector<std::string>& parts) {
  std::size_t combination = 0;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    if (std::ranges::find(run.differs, parts[i]) != run.differs.end())
      combination |= std::size_t{1} << i;
  }
  return combination;
}

/// Whether every combination is that of exactly one variation.
bool has_all_combinations(const Runs& runs, const std::vector<std::string>& parts) {
  std::map<std::size_t, std::set<std::string>> variations;
  for (const RunRecord* run : runs) variations[combination_of(*run, parts)].insert(run->variation);
  return variations.size() == std::size_t{1} << parts.size() &&
         std::ranges::all_of(variations, [](const auto& v) { return v.second.size() == 1; });
}

/// The flights and seeds that all combinations have.
std::vector<std::string> common_keys(const std::vector<Values>& combinations) {
  std::vector<std::string> keys;
  for (const auto& [key, value] : combinations.front()) {
    if (std::ranges::all_of(combinations, [&](const Values& v) { return v.contains(key); }))
      keys.push_back(key);
  }
  return keys;
}

/// The medians of all combinations over the drawn rows of `values` (row: flight and seed).
std::vector<double> medians_of(const std::vector<std::vector<double>>& values,
                               const std::vector<std::size_t>& drawn) {
  std::vector<double> medians, some(drawn.size());
  for (std::size_t c = 0; c < values.front().size(); ++c) {
    for (std::size_t i = 0; i < drawn.size(); ++i) some[i] = values[drawn[i]][c];
    medians.push_back(quantile(some, 0.5));
  }
  return medians;
}

bool all_finite(const std::vector<double>& values) {
  return std::ranges::all_of(values, [](double value) { return std::isfinite(value); });
}

void add_intervals(const std::vector<std::vector<double>>& values, std::size_t resamples,
                   std::vector<Contribution>& parts) {
  if (values.size() < kMinFlightsOfInterval || resamples == 0) return;
  const CounterRandom random(1, stream_of("contributions"));
  std::vector<std::vector<double>> low(parts.size()), high(parts.size());
  std::vector<std::size_t> drawn(values.size());
  for (std::size_t k = 0; k < resamples; ++k) {
    for (std::size_t i = 0; i < drawn.size(); ++i) {
      const double u = random.uniform(k, static_cast<std::uint32_t>(i));
      drawn[i] = static_cast<std::size_t>(u * static_cast<double>(values.size()));
    }
    const std::vector<double> worth = medians_of(values, drawn);
    const bool is_known = all_finite(worth);
    const std::vector<double> shares = is_known ? shapley_values(worth) : std::vector<double>{};
    for (std::size_t i = 0; i < parts.size(); ++i) {
      low[i].push_back(is_known ? shares[i] : -kInfinity);
      high[i].push_back(is_known ? shares[i] : kInfinity);
    }
  }
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const Interval interval{quantile(low[i], 0.025), quantile(high[i], 0.975)};
    if (std::isfinite(interval.low) && std::isfinite(interval.high)) parts[i].value_95 = interval;
  }
}

std::string names_in(std::size_t combination, const std::vector<std::string>& parts) {
  std::string names;
  for (std::size_t i = 0; i < parts.size(); ++i)
    if ((combination >> i & 1U) != 0) names += (names.empty() ? "" : " + ") + parts[i];
  return names.empty() ? "base" : names;
}

Contributions contributions_to(const Figure& figure, const Runs& runs,
                               const std::vector<std::string>& parts, std::size_t resamples) {
  Contributions found{.world = runs.front()->world,
                      .sensor = runs.front()->sensor,
                      .method = label_of(*runs.front()),
                      .figure = &figure,
                      .parts = {},
                      .missing = {}};
  std::vector<Values> combinations(std::size_t{1} << parts.size());
  for (const RunRecord* run : runs) {
    const RunFigure value = judged_figure(*run, figure);
    if (value.value)
      combinations[combination_of(*run, parts)][value.flight + "|" + value.seed] = *value.value;
  }
  const std::vector<std::string> keys = common_keys(combinations);
  found.flights = keys.size();
  if (keys.empty()) {
    found.missing = "no flight has this figure with all combinations";
    return found;
  }
  std::vector<std::vector<double>> values;
  std::vector<std::size_t> all_rows;
  for (const std::string& key : keys) {
    all_rows.push_back(values.size());
    values.emplace_back();
    for (const Values& combination : combinations) values.back().push_back(combination.at(key));
  }
  const std::vector<double> worth = medians_of(values, all_rows);
  found.base = worth.front();
  found.all = worth.back();
  for (std::size_t c = 0; c < worth.size(); ++c) {
    if (std::isfinite(worth[c])) continue;
    found.missing = "half of the runs are lost with: " + names_in(c, parts);
    return found;
  }
  const std::vector<double> shares = shapley_values(worth);
  for (std::size_t i = 0; i < parts.size(); ++i)
    found.parts.push_back({parts[i], shares[i], std::nullopt});
  add_intervals(values, resamples, found.parts);
  return found;
}

}  // namespace

std::vector<double> shapley_values(std::span<const double> worth) {
  const auto parts = static_cast<std::size_t>(std::bit_width(worth.size()) - 1);
  std::vector<double> weight(parts);  // of a combination without the part, by its size
  for (std::size_t size = 0; size < parts; ++size) {
    double orders = 1.0;  // size! (parts - size - 1)! / parts!, as 1 / (parts * binomial)
    for (std::size_t k = 1; k <= size; ++k)
      orders *= static_cast<double>(parts - k) / static_cast<double>(k);
    weight[size] = 1.0 / (static_cast<double>(parts) * orders);
  }
  std::vector<double> shares(parts);
  for (std::size_t c = 0; c < worth.size(); ++c) {
    for (std::size_t i = 0; i < parts; ++i) {
      const std::size_t bit = std::size_t{1} << i;
      if ((c & bit) != 0) continue;
      shares[i] += weight[static_cast<std::size_t>(std::popcount(c))] * (worth[c | bit] - worth[c]);
    }
  }
  return shares;
}

std::vector<Contributions> contributions_of(const StudyResults& results,
                                            std::span<const Figure* const> figures,
                                            std::size_t resamples) {
  const std::vector<std::string> parts = parts_of(results.rows);
  std::vector<Contributions> found;
  if (parts.size() < 2 || parts.size() > kMaxParts) return found;
  std::vector<std::string> order;
  std::map<std::string, Runs> groups;
  for (const RunRecord& run : results.rows) {
    const std::string name = run.world + "|" + run.sensor + "|" + label_of(run);
    if (!groups.contains(name)) order.push_back(name);
    groups[name].push_back(&run);
  }
  for (const std::string& name : order) {
    const Runs& runs = groups[name];
    if (!has_all_combinations(runs, parts)) continue;
    for (const Figure* figure : figures) {
      const bool is_known = std::ranges::any_of(
          runs, [&](const RunRecord* run) { return value_of(*run, *figure).has_value(); });
      if (is_known) found.push_back(contributions_to(*figure, runs, parts, resamples));
    }
  }
  return found;
}

}  // namespace lidarena::results
