// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>

#include "lidarena/base/config_json.hpp"
#include "lidarena/dataset/run_files.hpp"
#include "lidarena/evaluation/summary.hpp"

namespace lidarena::evaluation {

/// Memory of one kind over a run.
struct MemoryFigures {
  double peak_bytes = 0.0;
  double final_bytes = 0.0;
  /// Slope of the least-squares line over sensor time, without the first tenth of the run (in which
  /// buffers fill); 0 with fewer than three rows.
  double growth_bytes_per_s = 0.0;
};

/// Computing time and memory of a run, from its resources.csv.
struct ResourceFigures {
  std::size_t scans = 0;
  Summary latency_s;              ///< of each scan
  double real_time_factor = 0.0;  ///< sensor time / sum of latencies; above 1: keeps up
  /// Share of scans that took longer than the time to the next one, 0..1.
  double late_scans = 0.0;
  MemoryFigures rss, pss;  ///< of the whole process, including the harness
  MemoryFigures own;       ///< sum of the parts that the algorithm reports
  MemoryFigures map, scan_buffer, backlog;
};

/// Empty without rows.
std::optional<ResourceFigures> resource_figures(std::span<const dataset::ResourceRow> rows);

/// With the figures over sensor time: at most `limit` rows, each the maximum of several consecutive
/// ones. Null without rows.
Json resources_json(std::span<const dataset::ResourceRow> rows, std::size_t limit = 500);

}  // namespace lidarena::evaluation
