// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <string>

#include "lidarena/results/run_metrics.hpp"

/// The main figures of runs as text: for a terminal, as CSV, Markdown and LaTeX. Coverage
/// is shown beside every error; a run without figures is a row with the reason.
namespace lidarena::results {

/// One run and its metrics.
struct ScoredRun {
  std::string name;       ///< name of the folder or file
  std::string algorithm;  ///< with its preset; empty for trajectories that are not our runs
  std::string flight;     ///< dataset
  std::string seed;
  RunMetrics metrics;
  bool is_cut = false;  ///< a recording of its poses was cut off or damaged
};

/// Diagnostics (association, offsets, alignment, warnings), then the figures, each with the
/// coverage and number of samples that it is based on.
std::string metrics_text(const ScoredRun& run);

/// Long format, one row per figure: run, algorithm, flight, seed, status, reason, coverage_percent,
/// figure, definition, value, unit, used, total. A run without figures is one row.
std::string metrics_csv(std::span<const ScoredRun> runs);

/// One row per run. Below it a second table with further metrics of the re-projected maps.
std::string metrics_markdown(std::span<const ScoredRun> runs);

/// The same for the booktabs package.
std::string metrics_latex(std::span<const ScoredRun> runs);

}  // namespace lidarena::results
