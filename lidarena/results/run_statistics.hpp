// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "lidarena/base/config_json.hpp"
#include "lidarena/results/metrics_table.hpp"
#include "lidarena/results/statistics.hpp"

namespace lidarena::results {

/// Statistics of every figure, in the order of figures().
struct RunStatistics {
  struct OfAlgorithm {
    std::string algorithm;
    std::vector<Spread> figures;
  };
  struct OfPair {
    std::string a, b;
    std::vector<PairedComparison> figures;
  };
  std::vector<OfAlgorithm> algorithms;  ///< in the order of the runs
  std::optional<OfPair> paired;         ///< where there are exactly two algorithms
};
RunStatistics statistics_of(std::span<const ScoredRun> runs, std::uint64_t seed = 1);

/// "algorithms": {algorithm: {figure: {runs, kept, flights, failures, median, best, worst, ...}}},
/// and "paired". A value that is that of a lost run is "lost".
Json to_json(const RunStatistics& statistics);
/// The same as text for a terminal.
std::string statistics_text(const RunStatistics& statistics);

}  // namespace lidarena::results
