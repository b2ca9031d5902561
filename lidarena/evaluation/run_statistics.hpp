// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "lidarena/evaluation/metrics_table.hpp"

namespace lidarena::evaluation {

/// "algorithms": {algorithm: {figure: {runs, values, flights, failures, median, min, max, mean,
/// ...}}}, and under "paired" the comparison where there are exactly two algorithms (see
/// statistics.hpp).
Json statistics_json(std::span<const ScoredRun> runs, std::uint64_t seed = 1);
/// The same as text for a terminal.
std::string statistics_text(const Json& statistics);

}  // namespace lidarena::evaluation
