// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>

#include "lidarena/base/config_json.hpp"
#include "lidarena/dataset/run_files.hpp"
#include "lidarena/evaluation/summary.hpp"

namespace lidarena {

/// Memory of one kind over a run.
struct MemoryFigures {
  double peak_bytes = 0.0;
  double final_bytes = 0.0;
  /// Slope of the least-squares line over sensor time, from a tenth of the run on (buffers fill
  /// before); 0 with fewer than three rows.
  double growth_bytes_per_s = 0.0;
};

/// What a run cost, from its resources.csv.
struct ResourceFigures {
  std::size_t scans = 0;
  Summary latency_s;              ///< of each scan
  double real_time_factor = 0.0;  ///< sensor time over the sum of latencies; above 1 keeps up
  /// Share of scans that took longer than the time to the next one, 0..1.
  double late_scans = 0.0;
  MemoryFigures rss, pss;  ///< of the process; everything in it, the harness too
  MemoryFigures own;       ///< the algorithm's own parts together
  MemoryFigures map, scan_buffer, backlog;
};

/// Empty without rows.
std::optional<ResourceFigures> resource_figures(std::span<const ResourceRow> rows);

/// With the figures over sensor time: at most `limit` rows, each the largest of its neighbors.
/// Null without rows.
Json resources_json(std::span<const ResourceRow> rows, std::size_t limit = 500);

}  // namespace lidarena
