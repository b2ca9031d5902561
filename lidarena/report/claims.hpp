// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "lidarena/results/study_cells.hpp"

namespace lidarena::report {

/// A finding of the paper, checked with our own runs.
struct Claim {
  std::string text;                   ///< what the paper found
  std::string rule;                   ///< check applied to our figures, with the paper's figures
  std::vector<std::string> evidence;  ///< our figures
  std::optional<bool> holds;          ///< empty: our runs cannot tell; `evidence` has the reasons
  std::string possible_reason;  ///< possible reason for a difference; shown if it does not hold
};

/// The paper's findings, checked with the runs of one preset.
std::vector<Claim> paper_claims(const results::StudyResults& results, const std::string& preset);

}  // namespace lidarena::report
