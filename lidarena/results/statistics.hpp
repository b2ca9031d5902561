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
/// flights and seeds. A lost run (lost.hpp) has an infinite value, the worst: it is counted, listed
/// and part of every median, range and comparison.
namespace lidarena::results {

/// One figure of one run.
struct RunFigure {
  std::string flight;           ///< dataset; errors within one flight are correlated
  std::string seed;             ///< distinguishes runs of one flight
  std::optional<double> value;  ///< infinite if the run is lost; empty: it has no such figure
  std::string failure;          ///< why the run is lost ("diverged: ...") or has no such figure
  std::optional<double> zero_bound = std::nullopt;  ///< of a share of zero, see figures.hpp
};

struct Interval {
  double low = 0.0;
  double high = 0.0;
};

/// One figure over runs. The values of lost runs are infinite: the worst is infinite where a run is
/// lost, the median where half of them are, the best where all are.
struct Spread {
  std::size_t runs = 0;               ///< N: all runs
  std::size_t kept = 0;               ///< n: those that are not lost
  std::size_t flights = 0;            ///< flights with at least one value, lost runs included
  std::vector<std::string> failures;  ///< "FLIGHT SEED: reason", in the order of the runs
  std::optional<double> median, best, worst;  ///< empty where no run that is kept has the figure
  std::optional<Interval> median_95;          ///< empty below kMinFlightsOfInterval
  /// Where the median is a share of zero: the largest of the upper bounds of such shares.
  std::optional<double> zero_bound;

  bool is_lost() const;  ///< whether the median is that of a lost run
};

inline constexpr std::size_t kResamples = 10'000;
/// An interval at 95 % needs as many flights: the range of five holds the median of what they are
/// drawn from with a probability of 1 - 2 / 2^5 = 94 %, that of six with 97 %.
inline constexpr std::size_t kMinFlightsOfInterval = 6;

/// The interval is the percentile bootstrap (Efron, Tibshirani, "An introduction to the bootstrap",
/// 1993, ch. 13) of the median over *flights*: a flight is drawn with all of its runs, because runs
/// of one flight are not independent samples. Bit-identical for the same seed, whatever the order
/// of the runs.
Spread spread_of(std::span<const RunFigure> runs, Better better = Better::kLess,
                 std::uint64_t seed = 1, std::size_t resamples = kResamples);

/// Comparison of `b` with `a` on the same flights and seeds. A lost run is worse than any other.
/// Two lost runs carry no evidence and are no pair.
struct PairedComparison {
  std::size_t pairs = 0;             ///< pairs of runs that both have the figure
  std::vector<std::string> missing;  ///< "FLIGHT SEED: a: was not run", "...: lost with both"
  std::size_t b_smaller = 0, a_smaller = 0, ties = 0;
  double median_difference = 0.0;         ///< b - a; infinite where most pairs have one lost run
  std::optional<Interval> difference_95;  ///< as median_95 of Spread
  /// Two-sided p of Wilcoxon's signed-rank test; empty when all pairs are ties.
  std::optional<double> wilcoxon_p;
};
PairedComparison compare_paired(std::span<const RunFigure> a, std::span<const RunFigure> b,
                                std::uint64_t seed = 1, std::size_t resamples = kResamples);

/// Two-sided p of the hypothesis that the differences are symmetric about zero (Wilcoxon,
/// "Individual comparisons by ranking methods", 1945). Zeros are dropped, equal magnitudes share
/// their mean rank. Exact, by counting all combinations of signs, up to 50 differences; beyond, the
/// normal approximation with the variance of shared ranks. Empty when no difference is left.
std::optional<double> wilcoxon_signed_rank_p(std::span<const double> differences);

/// Level of a test that "better" needs.
inline constexpr double kLevel = 0.05;
/// The p values after Holm's correction for their number ("A simple sequentially rejective multiple
/// test procedure", 1979): the k-th smallest of n is multiplied by n - k + 1, and none is smaller
/// than one before it. In the given order.
std::vector<double> holm(std::span<const double> p);

}  // namespace lidarena::results
