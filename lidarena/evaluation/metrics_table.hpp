// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "lidarena/base/config_json.hpp"

/// The main figures of metrics.json as text: for a terminal, as CSV, Markdown and LaTeX. Coverage
/// stands beside every error; a run without a figure is a row with its reason.
namespace lidarena {

/// One run and its metrics.json.
struct ScoredRun {
  std::string name;       ///< of the folder or file
  std::string algorithm;  ///< with its preset; empty for files of others
  std::string flight;     ///< dataset
  std::string seed;
  Json metrics;
};

/// The diagnosis (association, offsets, gauge, warnings), then the figures, each with what it rests
/// on.
std::string metrics_text(const ScoredRun& run);

/// Long form, a row a figure: run, algorithm, flight, seed, status, reason, coverage_percent,
/// figure, definition, value, unit, used, total. A run without figures is one row.
std::string metrics_csv(std::span<const ScoredRun> runs);

/// A row a run, the best of each column bold where several runs have it; below it a second table of
/// what else is known of the re-projected maps.
std::string metrics_markdown(std::span<const ScoredRun> runs);

/// The same for the booktabs package: best bold, second best underlined, failures in words.
std::string metrics_latex(std::span<const ScoredRun> runs);

}  // namespace lidarena
