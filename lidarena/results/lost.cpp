// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/results/lost.hpp"

#include <fmt/format.h>

#include <limits>

namespace lidarena::results {
namespace {

std::string state_of(const std::string& status, const std::string& reason) {
  return reason.empty() ? status : status + ": " + reason;
}

/// Of RunMetrics or of a RunRecord.
template <class Run>
std::string lost_by_figures(const Run& run) {
  if (const auto share = value_of(run, kOwnMapOutliers); share && *share > kLostOutliers_percent)
    return fmt::format("lost: {:.0f} % of its own map lie beyond 20 cm", *share);
  if (const auto drift = value_of(run, kDrift); drift && *drift > kLostDrift_cm_per_m)
    return fmt::format("lost: it drifts by {:.3g} cm per m", *drift);
  return {};
}

}  // namespace

std::string lost_reason(const RunMetrics& metrics) {
  if (!metrics.is_ok()) return metrics.status_and_reason();
  return lost_by_figures(metrics);
}

std::string lost_reason(const RunRecord& run) {
  if (run.status != "ok") return state_of(run.status, run.reason);
  return run.metrics || run.known ? lost_by_figures(run) : std::string("not scored");
}

bool is_lost(const RunRecord& run) { return !lost_reason(run).empty(); }

double lost_value(const Figure& figure) {
  constexpr double kWorst = std::numeric_limits<double>::infinity();
  return figure.better == Better::kLess ? kWorst : -kWorst;
}

std::optional<double> judged_value(const RunMetrics& metrics, const Figure& figure) {
  return lost_reason(metrics).empty() ? value_of(metrics, figure) : lost_value(figure);
}

std::optional<double> judged_value(const RunRecord& run, const Figure& figure) {
  return is_lost(run) ? lost_value(figure) : value_of(run, figure);
}

RunFigure judged_figure(const RunRecord& run, const Figure& figure) {
  return {run.world + " " + run.flight + " " + run.mode, std::to_string(run.seed),
          judged_value(run, figure), lost_reason(run), zero_bound_of(run, figure)};
}

}  // namespace lidarena::results
