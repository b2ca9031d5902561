// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string>

#include "lidarena/results/run_metrics.hpp"

/// The main figures of a run: which numbers of RunMetrics tables, statistics and expectations show,
/// in which unit and under which name.
namespace lidarena::results {

/// Whether small or large values of a figure are better.
enum class Better { kLess, kMore };

/// What a figure says about.
enum class Subject { kLiveTrajectory, kTrajectory, kMap, kResources };

/// The tables of metrics_table.hpp in which a figure may be a column; the report's list of runs has
/// those of kMain and of kRuns.
enum class FigureTable { kNone, kMain, kMap, kRuns };

/// A number of a run with what it is based on.
struct Reading {
  std::optional<double> value;  ///< in the unit of RunMetrics
  std::string definition;       ///< id in docs/metrics.md
  std::string refused;          ///< why there is no value; empty if that is not known
  std::string warning;
  std::optional<std::size_t> used, total;  ///< pieces of the path, points of a map
  std::string samples;                     ///< "38 of 45 pieces", "900 of 1800 points"
  bool is_share = false;                   ///< a share of the `used` ones
};

/// The upper bound (%) of a share of which 0 of `n` independent samples were found, at a level of
/// 5 %: 300 / n.
double upper_bound_of_zero(std::size_t n);
/// That of a reading which is a share and zero; empty for any other.
std::optional<double> zero_bound(const Reading& reading);

/// One figure: where it stands in RunMetrics and how it is shown.
struct Figure {
  const char* key;      ///< name in CSV files, statistics and expectations
  const char* heading;  ///< of its column; null = in no table
  double factor;        ///< shown value / value in RunMetrics
  const char* unit;     ///< of the shown value
  const char* label;    ///< on a terminal
  Subject subject;
  Reading (*read)(const RunMetrics&);
  FigureTable table = FigureTable::kNone;
  Better better = Better::kLess;
};

// Those that tables and reports name; drift is the RPE per meter from pose to pose, maps are scored
// in the alignment of scores_of().
extern const Figure &kDrift, &kDriftRotation, &kAte, &kOwnMapRmse, &kOwnMapOutliers, &kMapRmse,
    &kMapOutliers, &kCpuP95, &kCpuLoad, &kOwnMemory, &kLiveDrift, &kOwnMapRmseToVertices,
    &kOwnMapBeyondVertices;

/// All of them, in the order in which they are shown.
std::span<const Figure> figures();
/// Name of a column of such values: the key with the unit.
std::string column_of(const Figure& figure);
/// The figure with this key. Throws InputError at `place`, with the nearest key, if there is none.
const Figure& figure_of(const std::string& key, const std::string& place);

/// The value in the figure's unit; empty if the run has none.
std::optional<double> value_of(const RunMetrics& metrics, const Figure& figure);
/// Share of the flight (%) that the trajectory behind the figure covers: the live one for its own
/// errors, else the final one.
std::optional<double> coverage_of(const RunMetrics& metrics, const Figure& figure);
/// That of the final trajectory.
std::optional<double> coverage_of(const RunMetrics& metrics);

}  // namespace lidarena::results
