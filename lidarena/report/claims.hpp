// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "lidarena/report/study_cells.hpp"

namespace lidarena {

/// A finding of the paper, judged by our own runs.
struct Claim {
  std::string text;                   ///< what the paper found
  std::string rule;                   ///< what is asked of our figures, and the paper's own
  std::vector<std::string> evidence;  ///< our figures
  std::optional<bool> holds;          ///< empty: our runs do not say, for the reasons in `evidence`
  std::string guess;                  ///< why ours may differ; shown where it does
};

/// The paper's findings on the runs of one preset.
std::vector<Claim> paper_claims(const Results& results, const std::string& preset);

}  // namespace lidarena
