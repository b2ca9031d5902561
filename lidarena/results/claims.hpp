// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "lidarena/results/run_record.hpp"

/// When a table, the decision or the page may say "better".
namespace lidarena::results {

/// Fewer pairs of runs than this support no claim.
inline constexpr std::size_t kMinPairs = 16;

using Runs = std::vector<const RunRecord*>;

/// Two sets of runs that are compared in one figure.
struct Contest {
  Runs a, b;
  const Figure* figure = nullptr;
};

/// What the pairs of runs on the same world, flight, timing mode and seed say, pooled over worlds.
struct Claim {
  std::size_t pairs = 0;
  std::optional<double> p;  ///< after Holm's correction; empty: too few pairs, or all are ties
  bool a_is_better = false, b_is_better = false;

  /// "24 pairs, p = 0.003", "8 pairs: too few for a claim", or that there is but one run a cell.
  std::string words() const;
};

/// One claim for each contest of a table. A side is better if the paired differences of at least
/// kMinPairs pairs pass Wilcoxon's signed-rank test at kLevel after Holm's correction for all
/// contests of the table that have as many pairs. A lost run is the worse one of its pair, two lost
/// ones tie.
std::vector<Claim> claims_of(std::span<const Contest> contests);
/// On how many pairs they rest ("at least 16 pairs"), or why none of them can claim anything.
std::string words_of(std::span<const Claim> claims);

}  // namespace lidarena::results
