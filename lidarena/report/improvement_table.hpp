// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "lidarena/results/run_record.hpp"
#include "lidarena/results/table.hpp"

namespace lidarena::report {

/// A step of a study by `lidarena improve`, or two of them together.
struct StepNote {
  std::string name;
  std::string note;  ///< its source
};

struct Improvement {
  results::Table table;
  std::vector<std::string> words;  ///< which step helps, and which does not
};

/// Of a study whose variations are steps: for each step the change of drift (live and final) and of
/// the map's error on the same flights and seeds, as medians with an interval at 95 % by bootstrap.
/// A step helps a figure if the interval is below zero and Wilcoxon's test passes 5 % after Holm's
/// correction for all steps in this figure; without the second it may help. Steps in the order of
/// `steps`, then those of two together.
Improvement improvement_of(const results::StudyResults& results,
                           const std::vector<StepNote>& steps);

}  // namespace lidarena::report
