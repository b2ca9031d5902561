// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>

#include "lidarena/results/figures.hpp"
#include "lidarena/results/run_record.hpp"
#include "lidarena/results/statistics.hpp"

/// What a lost run is, and how it counts: everywhere as the worst run of its cell. Medians, ranges,
/// comparisons, expectations and the decision include it; nothing leaves it out.
namespace lidarena::results {

/// If more of the own map than this lies beyond 20 cm, it is not a map of the world.
inline constexpr double kLostOutliers_percent = 50.0;
/// A drift above this (1 m per m, see kDrift) is worse than not to move at all.
inline constexpr double kLostDrift_cm_per_m = 100.0;

/// Why a run is lost: it has no scored result ("diverged: ...", "missing: ..."), its own map lies
/// mostly beyond 20 cm, or it drifts by more than 1 m per m. Empty if it is not lost.
std::string lost_reason(const RunMetrics& metrics);
std::string lost_reason(const RunRecord& run);
bool is_lost(const RunRecord& run);

/// The value that every figure of a lost run has: infinity, negative where more is better. It sorts
/// behind all others, and tables show it as "lost".
double lost_value(const Figure& figure);

/// The figure of a run in its unit, lost_value() if the run is lost; empty if a run that is not
/// lost has no such figure.
std::optional<double> judged_value(const RunMetrics& metrics, const Figure& figure);
std::optional<double> judged_value(const RunRecord& run, const Figure& figure);

/// The same for statistics, with the reason where the run is lost. Runs of one world, flight and
/// timing mode have the same `flight`.
RunFigure judged_figure(const RunRecord& run, const Figure& figure);

}  // namespace lidarena::results
