// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/evaluation/resources.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <utility>
#include <vector>

namespace lidarena::evaluation {
namespace {

using Bytes = std::function<std::uint64_t(const dataset::ResourceRow&)>;

std::uint64_t own_bytes(const dataset::ResourceRow& row) {
  return row.map_bytes + row.scan_buffer_bytes + row.backlog_bytes;
}

double slope_of(std::span<const dataset::ResourceRow> rows, const Bytes& bytes) {
  if (rows.size() < 3) return 0.0;
  const auto n = static_cast<double>(rows.size());
  double t_mean = 0.0;
  double b_mean = 0.0;
  for (const dataset::ResourceRow& row : rows) {
    t_mean += row.t_sensor_s / n;
    b_mean += static_cast<double>(bytes(row)) / n;
  }
  double tt = 0.0;
  double tb = 0.0;
  for (const dataset::ResourceRow& row : rows) {
    const double t = row.t_sensor_s - t_mean;
    tt += t * t;
    tb += t * (static_cast<double>(bytes(row)) - b_mean);
  }
  return tt > 0.0 ? tb / tt : 0.0;
}

MemoryFigures memory_of(std::span<const dataset::ResourceRow> rows, const Bytes& bytes) {
  MemoryFigures figures;
  for (const dataset::ResourceRow& row : rows) {
    figures.peak_bytes = std::max(figures.peak_bytes, static_cast<double>(bytes(row)));
  }
  figures.final_bytes = static_cast<double>(bytes(rows.back()));
  figures.growth_bytes_per_s = slope_of(rows.subspan(rows.size() / 10), bytes);
  return figures;
}

/// Share of scans that were not processed when the next one ended.
double late_share(std::span<const dataset::ResourceRow> rows) {
  if (rows.size() < 2) return 0.0;
  std::size_t late = 0;
  for (std::size_t i = 1; i < rows.size(); ++i) {
    if (rows[i - 1].latency_s > rows[i].t_sensor_s - rows[i - 1].t_sensor_s) ++late;
  }
  return static_cast<double>(late) / static_cast<double>(rows.size() - 1);
}

Json to_json(const MemoryFigures& figures) {
  return {{"peak_bytes", figures.peak_bytes},
          {"final_bytes", figures.final_bytes},
          {"growth_bytes_per_s", figures.growth_bytes_per_s}};
}

const std::array<std::pair<const char*, Bytes>, 6>& kinds() {
  static const std::array<std::pair<const char*, Bytes>, 6> kinds{{
      {"rss", [](const dataset::ResourceRow& r) { return r.rss_bytes; }},
      {"pss", [](const dataset::ResourceRow& r) { return r.pss_bytes; }},
      {"own", own_bytes},
      {"map", [](const dataset::ResourceRow& r) { return r.map_bytes; }},
      {"scan_buffer", [](const dataset::ResourceRow& r) { return r.scan_buffer_bytes; }},
      {"backlog", [](const dataset::ResourceRow& r) { return r.backlog_bytes; }},
  }};
  return kinds;
}

/// Columns t_s, latency_s and bytes of each kind.
Json over_time(std::span<const dataset::ResourceRow> rows, std::size_t limit) {
  const std::size_t run = std::max<std::size_t>(1, (rows.size() + limit - 1) / limit);
  Json columns{{"largest_of", run}, {"t_s", Json::array()}, {"latency_s", Json::array()}};
  for (const auto& [name, bytes] : kinds()) columns[std::string(name) + "_bytes"] = Json::array();
  for (std::size_t begin = 0; begin < rows.size(); begin += run) {
    const auto some = rows.subspan(begin, std::min(run, rows.size() - begin));
    columns["t_s"].push_back(some.front().t_sensor_s);
    double latency_s = 0.0;
    for (const dataset::ResourceRow& row : some) latency_s = std::max(latency_s, row.latency_s);
    columns["latency_s"].push_back(latency_s);
    for (const auto& [name, bytes] : kinds()) {
      std::uint64_t largest = 0;
      for (const dataset::ResourceRow& row : some) largest = std::max(largest, bytes(row));
      columns[std::string(name) + "_bytes"].push_back(largest);
    }
  }
  return columns;
}

}  // namespace

std::optional<ResourceFigures> resource_figures(std::span<const dataset::ResourceRow> rows) {
  if (rows.empty()) return std::nullopt;
  ResourceFigures figures;
  figures.scans = rows.size();
  std::vector<double> latencies;
  double compute_s = 0.0;
  for (const dataset::ResourceRow& row : rows) {
    latencies.push_back(row.latency_s);
    compute_s += row.latency_s;
  }
  figures.latency_s = summarize(latencies);
  if (compute_s > 0.0) figures.real_time_factor = rows.back().t_sensor_s / compute_s;
  figures.late_scans = late_share(rows);
  const std::array memory{&figures.rss, &figures.pss,         &figures.own,
                          &figures.map, &figures.scan_buffer, &figures.backlog};
  for (std::size_t i = 0; i < memory.size(); ++i) *memory[i] = memory_of(rows, kinds()[i].second);
  return figures;
}

Json resources_json(std::span<const dataset::ResourceRow> rows, std::size_t limit) {
  const std::optional<ResourceFigures> figures = resource_figures(rows);
  if (!figures) return nullptr;
  const Summary& latency = figures->latency_s;
  return {{"scans", figures->scans},
          {"latency",
           {{"median_s", latency.median},
            {"mean_s", latency.mean},
            {"p95_s", latency.p95},
            {"p99_s", latency.p99},
            {"max_s", latency.max}}},
          {"real_time_factor", figures->real_time_factor},
          {"late_scans", figures->late_scans},
          {"rss", to_json(figures->rss)},
          {"pss", to_json(figures->pss)},
          {"own", to_json(figures->own)},
          {"map", to_json(figures->map)},
          {"scan_buffer", to_json(figures->scan_buffer)},
          {"backlog", to_json(figures->backlog)},
          {"over_time", over_time(rows, limit)}};
}

}  // namespace lidarena::evaluation
