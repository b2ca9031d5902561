// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <span>
#include <string>

#include "lidarena/base/config_json.hpp"
#include "lidarena/evaluation/statistics.hpp"

namespace lidarena {

/// The tables of metrics_table.hpp.
enum class FigureTable { kNone, kMain, kMap };

/// A figure and where it stands in metrics.json.
struct MetricFigure {
  const char* key;
  const char* heading;  ///< in its table; null = in none
  const char* group;    ///< pointer to the object with definition, used, total
  const char* value;    ///< pointer from there
  double factor;
  const char* unit;
  const char* words;  ///< on a terminal
  FigureTable table = FigureTable::kNone;
  Better better = Better::kLess;
};

/// The main figures, in the order in which they are shown.
std::span<const MetricFigure> metric_figures();

/// What stands at `path` of `json`; null when some part of the way is not there.
const Json* find_in(const Json& json, const std::string& path);
/// The number there, times `factor`; empty when there is none.
std::optional<double> number_in(const Json& json, const std::string& path, double factor = 1.0);
/// The text there, or nothing.
std::string text_in(const Json& json, const std::string& path);

/// Why there is no such figure, where the JSON says so: at its group or at what that is a part of.
std::string refusal_of(const Json& metrics, const MetricFigure& figure);

std::optional<double> value_of(const Json& metrics, const MetricFigure& figure);
/// Of the "live" or the "final" trajectory.
std::optional<double> coverage_percent(const Json& metrics, const char* trajectory);
/// Errors of the live trajectory rest on its own coverage, all else on the final one's.
std::optional<double> coverage_of(const Json& metrics, const MetricFigure& figure);

/// "ok", "diverged", "failed", ...
std::string run_status(const Json& metrics);
/// "diverged: REASON", or the status alone.
std::string status_and_reason(const Json& metrics);

}  // namespace lidarena
