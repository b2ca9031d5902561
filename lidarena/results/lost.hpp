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

/// A drift above this (1 m per m, see kDrift) is worse than not to move at all.
inline constexpr double kLostDrift_cm_per_m = 100.0;
/// A heading that drifts by more (kDriftRotation) is that of another path within 5 m.
inline constexpr double kLostDrift_deg_per_m = 20.0;

/// Why a run is lost: it has no result of the whole flight ("ended at 4.6 s: ...", "diverged: ...",
/// "missing: ..."), a figure of its path is not finite, or it drifts by more than 1 m or 20 degrees
/// per m. Empty if it is not lost. A bad map is a figure, not a state.
std::string lost_reason(const RunMetrics& metrics);
std::string lost_reason(const RunRecord& run);
bool is_lost(const RunRecord& run);

/// When a run ended itself (s) and its drift until then (cm per m, if that is known).
struct EarlyEnd {
  double at_s = 0.0;
  std::optional<double> drift;
};
/// Empty if the run did not end itself, or if that instant is not known.
std::optional<EarlyEnd> early_end(const RunRecord& run);

/// The value that every figure of a lost run has: infinity, negative where more is better. It sorts
/// behind all others, and tables show it as "lost", or as "ended at 4.6 s" (StudyCells).
double lost_value(const Figure& figure);

/// The figure of a run in its unit, lost_value() if the run is lost; empty if a run that is not
/// lost has no such figure.
std::optional<double> judged_value(const RunMetrics& metrics, const Figure& figure);
std::optional<double> judged_value(const RunRecord& run, const Figure& figure);

/// The same for statistics, with the reason where the run is lost. Runs of one world, flight and
/// timing mode have the same `flight`.
RunFigure judged_figure(const RunRecord& run, const Figure& figure);

}  // namespace lidarena::results
