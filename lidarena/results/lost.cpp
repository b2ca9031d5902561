// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/results/lost.hpp"

#include <fmt/format.h>

#include <cmath>
#include <limits>

namespace lidarena::results {
namespace {

std::string state_of(const std::string& status, const std::string& reason) {
  return reason.empty() ? status : status + ": " + reason;
}

std::string ended_text(double at_s, const std::string& reason) {
  return fmt::format("ended at {:.1f} s: {}", at_s, reason);
}

/// Of RunMetrics or of a RunRecord.
template <class Run>
std::string lost_by_figures(const Run& run) {
  for (const Figure* figure : {&kDrift, &kLiveDrift, &kDriftRotation, &kAte}) {
    const auto value = value_of(run, *figure);
    if (value && !std::isfinite(*value))
      return fmt::format("lost: its {} is not finite", figure->label);
  }
  if (const auto drift = value_of(run, kDrift); drift && *drift > kLostDrift_cm_per_m)
    return fmt::format("lost: it drifts by {:.3g} cm per m", *drift);
  if (const auto turn = value_of(run, kDriftRotation); turn && *turn > kLostDrift_deg_per_m)
    return fmt::format("lost: it drifts by {:.3g} degrees per m", *turn);
  return {};
}

}  // namespace

std::string lost_reason(const RunMetrics& metrics) {
  if (!metrics.is_ok() && metrics.ended_at_s)
    return ended_text(*metrics.ended_at_s, metrics.reason);
  if (!metrics.is_ok()) return metrics.status_and_reason();
  return lost_by_figures(metrics);
}

std::string lost_reason(const RunRecord& run) {
  if (run.status != "ok") {
    const std::optional<EarlyEnd> end = early_end(run);
    return end ? ended_text(end->at_s, run.reason) : state_of(run.status, run.reason);
  }
  return run.metrics || run.known ? lost_by_figures(run) : std::string("not scored");
}

std::optional<EarlyEnd> early_end(const RunRecord& run) {
  const std::optional<double> at_s = ended_at_s(run);
  if (!at_s || run.status == "ok") return std::nullopt;
  return EarlyEnd{*at_s, value_of(run, kDrift)};
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
