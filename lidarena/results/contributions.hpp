// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "lidarena/results/claims.hpp"
#include "lidarena/results/run_record.hpp"
#include "lidarena/results/statistics.hpp"

/// What each of several changes contributes to the difference between two settings, if all their
/// combinations were flown.
namespace lidarena::results {

/// Exact Shapley values ("A value for n-person games", 1953) of n parts: the mean, over all orders
/// in which the parts can be changed, of what each changes. `worth` has 2^n values; bit i of an
/// index is set if part i is changed. Their sum is worth.back() - worth.front().
std::vector<double> shapley_values(std::span<const double> worth);

struct Contribution {
  std::string name;
  double value = 0.0;  ///< in the unit of the figure
  std::optional<Interval> value_95;
};

/// The contributions to one figure, of one sensor and method in one world.
struct Contributions {
  std::string world, sensor, method;
  const Figure* figure = nullptr;
  std::size_t flights = 0;  ///< pairs of flight and seed that all combinations have
  double base = 0.0;        ///< median with nothing changed
  double all = 0.0;         ///< median with all changed
  std::vector<Contribution> parts;
  std::string missing;  ///< why there are none; empty if there are
};

/// Of a study that flew all combinations of 2 to 10 changes (named sets with sets_as: all, or keys
/// with one value each); empty for any other. The worth of a combination is the median of its runs,
/// in which a lost run is infinite; there are no contributions if the median of any combination is
/// that of a lost run. The intervals are percentile bootstraps over flights and seeds, the same
/// ones for all combinations; a resample with a lost median counts as the lowest and as the
/// highest, and there is no interval below kMinFlightsOfInterval. Bit-identical for the same
/// runs in any order.
std::vector<Contributions> contributions_of(const StudyResults& results,
                                            std::span<const Figure* const> figures,
                                            std::size_t resamples = 2000);

}  // namespace lidarena::results
