// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "lidarena/results/run_record.hpp"
#include "lidarena/results/statistics.hpp"

/// When a table, the decision or the page may say "better".
namespace lidarena::results {

/// Fewer independent pairs of runs than this support no claim. Pairs of one seed in one world share
/// that world and are counted once. The test itself takes each of them.
inline constexpr std::size_t kMinPairs = 16;

using Runs = std::vector<const RunRecord*>;

/// Two sets of runs that are compared in one figure: of one world, or of several.
struct Contest {
  Runs a, b;
  const Figure* figure = nullptr;
};

/// What the pairs of runs on the same world, flight, timing mode and seed say. A lost run is the
/// worse one of its pair. Two lost ones carry no evidence: they are no pair.
struct Claim {
  std::size_t pairs = 0;
  std::size_t independent = 0;  ///< the worlds and seeds that they are of
  std::optional<double> p;      ///< after Holm's correction; empty: too few pairs, or all are ties
  bool a_is_better = false, b_is_better = false;
  /// b / a, with the interval at 95 %: the Hodges-Lehmann ratio of stratified.hpp.
  std::optional<double> ratio;
  std::optional<Interval> ratio_95;

  /// "24 pairs, p = 0.003", "8 pairs: too few for a claim", or that there is but one run a cell.
  /// Pairs are the independent ones.
  std::string words() const;
  /// "ratio 0.33 (0.25 to 0.41)"; empty without a ratio.
  std::string ratio_words() const;
};

/// One claim for each contest of a page. A side is better if the log ratios of at least kMinPairs
/// independent pairs pass the test of stratified.hpp, with the worlds as strata, at kLevel after
/// Holm's correction for all contests of the page, in whatever figure, that have as many pairs.
std::vector<Claim> claims_of(std::span<const Contest> contests);
/// On how many pairs they rest ("at least 16 pairs"), or why none of them can claim anything.
std::string words_of(std::span<const Claim> claims);

}  // namespace lidarena::results
