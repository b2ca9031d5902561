// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

/// What several runs say together: seeds and flights of one algorithm, and two algorithms on the
/// same ones. A run that failed or diverged is counted and named, never left out in silence.
namespace lidarena {

/// One figure of one run.
struct RunFigure {
  std::string flight;           ///< what was flown where; errors within one flight are alike
  std::string seed;             ///< tells runs of one flight apart
  std::optional<double> value;  ///< empty when the run has no such figure, ...
  std::string failure;          ///< ... and why ("diverged: ...")
};

struct Interval {
  double low = 0.0;
  double high = 0.0;
};

/// Of the runs that have the figure; `failures` says what the others were.
struct Spread {
  std::size_t runs = 0;               ///< all, with or without the figure
  std::size_t values = 0;             ///< with it
  std::size_t flights = 0;            ///< with at least one value
  std::vector<std::string> failures;  ///< "FLIGHT SEED: reason", in the order of the runs
  double median = 0.0, min = 0.0, max = 0.0, mean = 0.0;
  /// Median with every failure counted as worse than all: empty when half of the runs failed.
  std::optional<double> median_with_failures;
  std::optional<Interval> median_95;  ///< empty with fewer than three flights
};

inline constexpr std::size_t kResamples = 10'000;

/// Which values of a figure are the good ones.
enum class Better { kLess, kMore };

/// The interval is the percentile bootstrap (Efron, Tibshirani, "An introduction to the bootstrap",
/// 1993, ch. 13) of the median over *flights*: a flight is drawn with all of its runs, for runs of
/// one flight are no independent samples. The same bits for the same seed, whatever the order of
/// the runs.
Spread spread_of(std::span<const RunFigure> runs, std::uint64_t seed = 1,
                 std::size_t resamples = kResamples, Better better = Better::kLess);

/// `b` against `a` on the same flights and seeds.
struct PairedComparison {
  std::size_t pairs = 0;             ///< both have the figure
  std::vector<std::string> missing;  ///< "FLIGHT SEED: a failed: reason", not compared
  std::size_t b_smaller = 0, a_smaller = 0, ties = 0;
  double median_difference = 0.0;         ///< b - a
  std::optional<Interval> difference_95;  ///< as median_95 of Spread
  /// Two-sided p of Wilcoxon's signed-rank test; empty when all pairs are ties.
  std::optional<double> wilcoxon_p;
};
PairedComparison compare_paired(std::span<const RunFigure> a, std::span<const RunFigure> b,
                                std::uint64_t seed = 1, std::size_t resamples = kResamples);

/// Two-sided p that the differences have their middle at zero (Wilcoxon, "Individual comparisons by
/// ranking methods", 1945). Zeros are dropped, equal magnitudes share their mean rank. Exact, by
/// counting all signs, up to 200 differences; beyond, the normal approximation. Empty when none is
/// left.
std::optional<double> wilcoxon_signed_rank_p(std::span<const double> differences);

}  // namespace lidarena
