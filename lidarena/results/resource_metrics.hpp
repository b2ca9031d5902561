// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "lidarena/results/summary.hpp"

namespace lidarena::results {

/// Memory of one kind over a run.
struct MemoryMetrics {
  double peak_bytes = 0.0;
  double final_bytes = 0.0;
  /// Slope of the least-squares line over sensor time, without the first tenth of the run (in which
  /// buffers fill); 0 with fewer than three rows.
  double growth_bytes_per_s = 0.0;
  double growth_r_squared = 0.0;  ///< of that line; near 1 where memory grows evenly

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("peak_bytes", self.peak_bytes, "B", "");
    v("final_bytes", self.final_bytes, "B", "");
    v("growth_bytes_per_s", self.growth_bytes_per_s, "B/s",
      "slope of the least-squares line over sensor time, without the first tenth");
    v("growth_r_squared", self.growth_r_squared, "", "of that line, 0..1");
  }
};

/// Columns; each row is the maximum of `largest_of` consecutive scans.
struct ResourcesOverTime {
  static constexpr const char* kTitle = "ResourcesOverTime";
  std::size_t largest_of = 1;
  std::vector<double> t_s, latency_s;
  std::vector<std::uint64_t> rss_bytes, pss_bytes, own_bytes, map_bytes, scan_buffer_bytes,
      backlog_bytes;

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("largest_of", self.largest_of, "", "consecutive scans behind one row");
    v("t_s", self.t_s, "s", "sensor time");
    v("latency_s", self.latency_s, "s", "of one scan");
    v("rss_bytes", self.rss_bytes, "B", "whole process");
    v("pss_bytes", self.pss_bytes, "B", "whole process, shared pages in proportion");
    v("own_bytes", self.own_bytes, "B", "map, scan buffer and backlog");
    v("map_bytes", self.map_bytes, "B", "");
    v("scan_buffer_bytes", self.scan_buffer_bytes, "B", "");
    v("backlog_bytes", self.backlog_bytes, "B", "");
  }
};

/// Computing time and memory of a run.
struct ResourceMetrics {
  std::size_t scans = 0;
  SummaryInSeconds latency;       ///< of each scan
  double real_time_factor = 0.0;  ///< sensor time / sum of latencies; above 1: keeps up
  double late_scans = 0.0;        ///< share of scans that took longer than the time to the next one
  SummaryInSeconds cpu;           ///< CPU time of each scan, over all threads; empty: not measured
  std::optional<double> cpu_load_percent;  ///< CPU time / sensor time: 100 = one core
  std::optional<double> cpu_late_scans;    ///< late_scans of one core: by CPU time
  MemoryMetrics rss, pss;                  ///< of the whole process, including the harness
  MemoryMetrics own;                       ///< sum of the parts that the algorithm reports
  MemoryMetrics map, scan_buffer, backlog;
  ResourcesOverTime over_time;
  bool empty() const { return scans == 0; }

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("scans", self.scans, "", "");
    v("latency", self.latency, "", "processing time of a scan");
    v("real_time_factor", self.real_time_factor, "", "sensor time / computing time");
    v("late_scans", self.late_scans, "", "share of scans that took longer than their period, 0..1");
    v("cpu", self.cpu, "", "CPU time of a scan, over all threads");
    v("cpu_load_percent", self.cpu_load_percent, "%", "CPU time / sensor time: 100 = one core");
    v("cpu_late_scans", self.cpu_late_scans, "",
      "share of scans whose CPU time is longer than their period, 0..1");
    v("rss", self.rss, "", "resident memory of the process");
    v("pss", self.pss, "", "the same, shared pages in proportion");
    v("own", self.own, "", "map, scan buffer and backlog as the algorithm counts them");
    v("map", self.map, "", "");
    v("scan_buffer", self.scan_buffer, "", "");
    v("backlog", self.backlog, "", "");
    v("over_time", self.over_time, "", "");
  }
};

}  // namespace lidarena::results
