// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/results/claims.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "lidarena/results/lost.hpp"
#include "lidarena/results/statistics.hpp"

namespace lidarena::results {
namespace {

std::vector<RunFigure> figures_of(const Runs& runs, const Figure& figure) {
  std::vector<RunFigure> found;
  for (const RunRecord* run : runs) found.push_back(judged_figure(*run, figure));
  return found;
}

}  // namespace

std::string Claim::words() const {
  if (pairs == 0) return "no pairs: untested";
  if (pairs == 1) return "one run a cell: no claim";
  if (pairs < kMinPairs) return fmt::format("{} pairs: too few for a claim", pairs);
  return p ? fmt::format("{} pairs, p = {:.2g}", pairs, *p) : fmt::format("{} equal pairs", pairs);
}

std::vector<Claim> claims_of(std::span<const Contest> contests) {
  std::vector<Claim> claims;
  std::vector<double> p;
  std::vector<bool> b_ranks_smaller;
  for (const Contest& contest : contests) {
    const PairedComparison compared = compare_paired(figures_of(contest.a, *contest.figure),
                                                     figures_of(contest.b, *contest.figure), 1, 0);
    claims.push_back({compared.pairs, std::nullopt, false, false});
    b_ranks_smaller.push_back(compared.b_ranks_smaller);
    if (compared.pairs < kMinPairs || !compared.wilcoxon_p) continue;
    claims.back().p = compared.wilcoxon_p;
    p.push_back(*compared.wilcoxon_p);
  }
  const std::vector<double> corrected = holm(p);
  for (std::size_t i = 0, k = 0; i < claims.size(); ++i) {
    if (!claims[i].p) continue;
    claims[i].p = corrected[k++];
    if (*claims[i].p >= kLevel) continue;
    const bool less_is_better = contests[i].figure->better == Better::kLess;
    claims[i].b_is_better = b_ranks_smaller[i] == less_is_better;
    claims[i].a_is_better = !claims[i].b_is_better;
  }
  return claims;
}

std::string words_of(std::span<const Claim> claims) {
  const auto fewest = std::ranges::min_element(claims, {}, &Claim::pairs);
  if (fewest == claims.end()) return "nothing to compare";
  return fewest->pairs < kMinPairs ? fewest->words()
                                   : fmt::format("at least {} pairs", fewest->pairs);
}

}  // namespace lidarena::results
