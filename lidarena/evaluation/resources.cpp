// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/evaluation/resources.hpp"

#include <algorithm>
#include <cstdint>
#include <vector>

namespace lidarena::evaluation {
namespace {

using dataset::ResourceRow;
using Rows = std::span<const ResourceRow>;
using Bytes = std::uint64_t (*)(const ResourceRow&);

/// A kind of memory: how a row gives it, and where its figures and its curve go.
struct Kind {
  Bytes bytes;
  results::MemoryMetrics results::ResourceMetrics::*metrics;
  std::vector<std::uint64_t> results::ResourcesOverTime::*curve;
};

using Metrics = results::ResourceMetrics;
using Curves = results::ResourcesOverTime;
constexpr Kind kKinds[] = {
    {[](const ResourceRow& r) { return r.rss_bytes; }, &Metrics::rss, &Curves::rss_bytes},
    {[](const ResourceRow& r) { return r.pss_bytes; }, &Metrics::pss, &Curves::pss_bytes},
    {[](const ResourceRow& r) { return r.map_bytes + r.scan_buffer_bytes + r.backlog_bytes; },
     &Metrics::own, &Curves::own_bytes},
    {[](const ResourceRow& r) { return r.map_bytes; }, &Metrics::map, &Curves::map_bytes},
    {[](const ResourceRow& r) { return r.scan_buffer_bytes; }, &Metrics::scan_buffer,
     &Curves::scan_buffer_bytes},
    {[](const ResourceRow& r) { return r.backlog_bytes; }, &Metrics::backlog,
     &Curves::backlog_bytes},
};

results::MemoryMetrics memory_of(Rows rows, Bytes bytes) {
  results::MemoryMetrics memory;
  std::vector<double> times, values;
  for (const ResourceRow& row : rows) {
    times.push_back(row.t_sensor_s);
    values.push_back(static_cast<double>(bytes(row)));
  }
  memory.peak_bytes = *std::ranges::max_element(values);
  memory.final_bytes = values.back();
  const std::size_t begin = rows.size() / 10;
  const results::Line growth =
      results::fit_line(std::span(times).subspan(begin), std::span(values).subspan(begin));
  memory.growth_bytes_per_s = growth.slope;
  memory.growth_r_squared = growth.r_squared;
  return memory;
}

/// Share of scans whose `time` is longer than that to the end of the next one.
double late_share(Rows rows, double ResourceRow::*time) {
  if (rows.size() < 2) return 0.0;
  std::size_t late = 0;
  for (std::size_t i = 1; i < rows.size(); ++i) {
    if (rows[i - 1].*time > rows[i].t_sensor_s - rows[i - 1].t_sensor_s) ++late;
  }
  return static_cast<double>(late) / static_cast<double>(rows.size() - 1);
}

Curves curves_of(Rows rows, std::size_t limit) {
  Curves curves;
  curves.largest_of = std::max<std::size_t>(1, (rows.size() + limit - 1) / limit);
  for (std::size_t begin = 0; begin < rows.size(); begin += curves.largest_of) {
    const Rows some = rows.subspan(begin, std::min(curves.largest_of, rows.size() - begin));
    curves.t_s.push_back(some.front().t_sensor_s);
    curves.latency_s.push_back(std::ranges::max(some, {}, &ResourceRow::latency_s).latency_s);
    for (const Kind& kind : kKinds) {
      (curves.*kind.curve).push_back(kind.bytes(std::ranges::max(some, {}, kind.bytes)));
    }
  }
  return curves;
}

}  // namespace

Metrics resource_metrics(Rows rows, std::size_t limit) {
  Metrics metrics;
  if (rows.empty()) return metrics;
  metrics.scans = rows.size();
  std::vector<double> latencies, cpu;
  double compute_s = 0.0, cpu_s = 0.0;
  for (const ResourceRow& row : rows) {
    latencies.push_back(row.latency_s);
    cpu.push_back(row.cpu_s);
    compute_s += row.latency_s;
    cpu_s += row.cpu_s;
  }
  metrics.latency = results::summarize(latencies);
  metrics.cpu = results::summarize(cpu);
  if (rows.back().t_sensor_s > 0.0)
    metrics.cpu_load_percent = 100.0 * cpu_s / rows.back().t_sensor_s;
  metrics.cpu_late_scans = late_share(rows, &ResourceRow::cpu_s);
  if (compute_s > 0.0) metrics.real_time_factor = rows.back().t_sensor_s / compute_s;
  metrics.late_scans = late_share(rows, &ResourceRow::latency_s);
  for (const Kind& kind : kKinds) metrics.*kind.metrics = memory_of(rows, kind.bytes);
  metrics.over_time = curves_of(rows, limit);
  return metrics;
}

}  // namespace lidarena::evaluation
