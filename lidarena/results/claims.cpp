// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/results/claims.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>
#include <tuple>
#include <utility>

#include "lidarena/results/lost.hpp"
#include "lidarena/results/stratified.hpp"
#include "lidarena/results/table.hpp"

namespace lidarena::results {
namespace {

/// What the two runs of a pair have in common.
using Place = std::tuple<std::string, std::string, std::string, std::uint64_t>;

Place place_of(const RunRecord& run) { return {run.world, run.flight, run.mode, run.seed}; }

struct Pairs {
  std::map<std::string, std::vector<double>> log_ratios;        ///< by world
  std::set<std::pair<std::string, std::uint64_t>> independent;  ///< their worlds and seeds
};

Pairs pairs_of(const Contest& contest) {
  std::map<Place, const RunRecord*> others;
  for (const RunRecord* run : contest.b) others[place_of(*run)] = run;
  Pairs pairs;
  for (const RunRecord* run : contest.a) {
    const auto other = others.find(place_of(*run));
    if (other == others.end()) continue;
    const auto a = judged_value(*run, *contest.figure);
    const auto b = judged_value(*other->second, *contest.figure);
    if (!a || !b) continue;
    const auto ratio = log_ratio(*a, *b);
    if (!ratio) continue;
    pairs.log_ratios[run->world].push_back(*ratio);
    pairs.independent.emplace(run->world, run->seed);
  }
  return pairs;
}

}  // namespace

std::string Claim::words() const {
  if (independent == 0) return "no pairs: untested";
  if (pairs == 1) return "one run a cell: no claim";
  if (independent < kMinPairs) return fmt::format("{} pairs: too few for a claim", independent);
  return p ? fmt::format("{} pairs, p = {:.2g}", independent, *p)
           : fmt::format("{} equal pairs", independent);
}

std::string Claim::ratio_words() const {
  if (!ratio) return {};
  const auto shown = [](double value) { return number(value, 2).text; };
  const std::string range =
      ratio_95 ? fmt::format(" ({} to {})", shown(ratio_95->low), shown(ratio_95->high)) : "";
  return "ratio " + shown(*ratio) + range;
}

std::vector<Claim> claims_of(std::span<const Contest> contests) {
  std::vector<Claim> claims;
  std::vector<double> p;
  std::vector<bool> b_is_smaller;
  for (const Contest& contest : contests) {
    const Pairs made = pairs_of(contest);
    std::vector<std::vector<double>> strata;
    for (const auto& [world, ratios] : made.log_ratios) strata.push_back(ratios);
    const StratifiedComparison compared = compare_strata(strata);
    claims.push_back({.pairs = compared.pairs,
                      .independent = made.independent.size(),
                      .p = std::nullopt,
                      .ratio = compared.ratio,
                      .ratio_95 = compared.ratio_95});
    b_is_smaller.push_back(compared.b_is_smaller);
    if (claims.back().independent < kMinPairs || !compared.p) continue;
    claims.back().p = compared.p;
    p.push_back(*compared.p);
  }
  const std::vector<double> corrected = holm(p);
  for (std::size_t i = 0, k = 0; i < claims.size(); ++i) {
    if (!claims[i].p) continue;
    claims[i].p = corrected[k++];
    if (*claims[i].p >= kLevel) continue;
    const bool less_is_better = contests[i].figure->better == Better::kLess;
    claims[i].b_is_better = b_is_smaller[i] == less_is_better;
    claims[i].a_is_better = !claims[i].b_is_better;
  }
  return claims;
}

std::string words_of(std::span<const Claim> claims) {
  const auto fewest = std::ranges::min_element(claims, {}, &Claim::independent);
  if (fewest == claims.end()) return "nothing to compare";
  return fewest->independent < kMinPairs ? fewest->words()
                                         : fmt::format("at least {} pairs", fewest->independent);
}

}  // namespace lidarena::results
