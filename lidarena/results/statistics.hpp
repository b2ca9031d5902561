// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "lidarena/results/figures.hpp"

/// Statistics over several runs: seeds and flights of one algorithm, and two algorithms on the same
/// flights and seeds. Runs that failed or diverged are counted and listed, never left out silently.
namespace lidarena::results {

/// One figure of one run.
struct RunFigure {
  std::string flight;           ///< dataset; errors within one flight are correlated
  std::string seed;             ///< distinguishes runs of one flight
  std::optional<double> value;  ///< empty when the run has no such figure, ...
  std::string failure;          ///< ... and why ("diverged: ...")
};

struct Interval {
  double low = 0.0;
  double high = 0.0;
};

/// Statistics of the runs that have the figure; `failures` lists the others.
struct Spread {
  std::size_t runs = 0;               ///< all runs, with or without the figure
  std::size_t values = 0;             ///< runs with the figure
  std::size_t flights = 0;            ///< flights with at least one value
  std::vector<std::string> failures;  ///< "FLIGHT SEED: reason", in the order of the runs
  double median = 0.0, min = 0.0, max = 0.0, mean = 0.0;
  /// Median with every failure counted as worse than all: empty when half of the runs failed.
  std::optional<double> median_with_failures;
  std::optional<Interval> median_95;  ///< empty with fewer than three flights
};

inline constexpr std::size_t kResamples = 10'000;

/// The interval is the percentile bootstrap (Efron, Tibshirani, "An introduction to the bootstrap",
/// 1993, ch. 13) of the median over *flights*: a flight is drawn with all of its runs, because runs
/// of one flight are not independent samples. Bit-identical for the same seed, whatever the order
/// of the runs.
Spread spread_of(std::span<const RunFigure> runs, std::uint64_t seed = 1,
                 std::size_t resamples = kResamples, Better better = Better::kLess);

/// Comparison of `b` with `a` on the same flights and seeds.
struct PairedComparison {
  std::size_t pairs = 0;             ///< pairs of runs that both have the figure
  std::vector<std::string> missing;  ///< "FLIGHT SEED: a failed: reason", not compared
  std::size_t b_smaller = 0, a_smaller = 0, ties = 0;
  double median_difference = 0.0;         ///< b - a
  std::optional<Interval> difference_95;  ///< as median_95 of Spread
  /// Two-sided p of Wilcoxon's signed-rank test; empty when all pairs are ties.
  std::optional<double> wilcoxon_p;
};
PairedComparison compare_paired(std::span<const RunFigure> a, std::span<const RunFigure> b,
                                std::uint64_t seed = 1, std::size_t resamples = kResamples);

/// Two-sided p of the hypothesis that the differences are symmetric about zero (Wilcoxon,
/// "Individual comparisons by ranking methods", 1945). Zeros are dropped, equal magnitudes share
/// their mean rank. Exact, by counting all combinations of signs, up to 200 differences; beyond,
/// the normal approximation. Empty when no difference is left.
std::optional<double> wilcoxon_signed_rank_p(std::span<const double> differences);

}  // namespace lidarena::results
