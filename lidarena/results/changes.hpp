// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <string>
#include <vector>

#include "lidarena/results/run_record.hpp"
#include "lidarena/results/statistics.hpp"

namespace lidarena::results {

/// What one variation of a study does to one figure, of one sensor and method in one world.
struct Change {
  std::string world, sensor, method;
  const Figure* figure = nullptr;
  std::string variation;
  PairedComparison paired;  ///< the variation's runs with those of the base, by flight and seed
};

/// Of each variation that differs from the base of the study in a single key or set; in the order
/// of the runs. Variations without a pair of runs that have the figure are left out.
std::vector<Change> changes_of(const StudyResults& results, std::span<const Figure* const> figures);

}  // namespace lidarena::results
