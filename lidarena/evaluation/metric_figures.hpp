// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <span>
#include <string>

#include "lidarena/base/config_json.hpp"
#include "lidarena/evaluation/statistics.hpp"

namespace lidarena::evaluation {

/// The tables of metrics_table.hpp in which a figure may be a column.
enum class FigureTable { kNone, kMain, kMap };

/// One number of the evaluation and its location in metrics.json.
struct MetricFigure {
  const char* key;
  const char* heading;  ///< of its column; null = in no table
  const char* group;    ///< JSON pointer to the object with definition, used, total
  const char* value;    ///< JSON pointer from there to the number
  double factor;
  const char* unit;
  const char* label;  ///< label on a terminal
  FigureTable table = FigureTable::kNone;
  Better better = Better::kLess;
};

/// The main figures, in the order in which they are shown.
std::span<const MetricFigure> metric_figures();

/// The value at JSON pointer `path`; null when it does not exist.
const Json* find_in(const Json& json, const std::string& path);
/// The number at `path`, times `factor`; empty when there is none.
std::optional<double> number_in(const Json& json, const std::string& path, double factor = 1.0);
/// The string at `path`; empty when there is none.
std::string text_in(const Json& json, const std::string& path);

/// Why the figure is missing: "refused" of its group or of an enclosing object; else empty.
std::string refusal_of(const Json& metrics, const MetricFigure& figure);

std::optional<double> value_of(const Json& metrics, const MetricFigure& figure);
/// Coverage of the "live" or the "final" trajectory.
std::optional<double> coverage_percent(const Json& metrics, const char* trajectory);
/// Coverage that applies to the figure: that of the live trajectory for its own errors, that of the
/// final one for all others.
std::optional<double> coverage_of(const Json& metrics, const MetricFigure& figure);

/// "ok", "diverged", "failed", ...
std::string run_status(const Json& metrics);
/// "diverged: REASON", or the status alone.
std::string status_and_reason(const Json& metrics);

}  // namespace lidarena::evaluation
