// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/evaluation/resources.hpp"

#include <gtest/gtest.h>

namespace lidarena::evaluation {
namespace {

/// 100 scans at 10 Hz that take 20 ms, every twentieth 150 ms; the map grows by 1 kB per scan, the
/// buffer is constant, the backlog has one peak.
std::vector<dataset::ResourceRow> rows_of_a_run() {
  std::vector<dataset::ResourceRow> rows;
  for (int i = 0; i < 100; ++i) {
    dataset::ResourceRow row;
    row.t_sensor_s = 0.1 * (i + 1);
    row.latency_s = i % 20 == 7 ? 0.15 : 0.02;
    row.cpu_s = i % 10 == 7 ? 0.3 : 0.06;
    row.map_bytes = 1000U * static_cast<std::uint64_t>(i + 1);
    row.scan_buffer_bytes = 500;
    row.backlog_bytes = i == 33 ? 7777 : 0;
    row.rss_bytes = 50'000'000 + row.map_bytes;
    row.pss_bytes = 40'000'000 + row.map_bytes;
    rows.push_back(row);
  }
  return rows;
}

TEST(Resources, LatencyAndRealTimeFactorOfAKnownRun) {
  const results::ResourceMetrics figures = resource_metrics(rows_of_a_run());
  EXPECT_EQ(figures.scans, 100U);
  EXPECT_DOUBLE_EQ(figures.latency.median, 0.02);
  EXPECT_DOUBLE_EQ(figures.latency.max, 0.15);
  // five of a hundred are slow: rank 0.95 * 99 = 94.05 is 5 % of the way to the first of them
  EXPECT_NEAR(figures.latency.p95, 0.02 + 0.05 * 0.13, 1e-12);
  EXPECT_DOUBLE_EQ(figures.latency.p99, 0.15);
  EXPECT_NEAR(figures.real_time_factor, 10.0 / (95 * 0.02 + 5 * 0.15), 1e-12);
  EXPECT_NEAR(figures.late_scans, 5.0 / 99.0, 1e-12);
}

TEST(Resources, CpuTimeSaysWhatOneCoreWouldDo) {
  const results::ResourceMetrics figures = resource_metrics(rows_of_a_run());
  EXPECT_DOUBLE_EQ(figures.cpu.median, 0.06);
  EXPECT_NEAR(*figures.cpu_load_percent, 100.0 * (90 * 0.06 + 10 * 0.3) / 10.0, 1e-9);
  EXPECT_NEAR(*figures.cpu_late_scans, 10.0 / 99.0, 1e-12) << "two cores keep up, one does not";
}

TEST(Resources, MemoryHasItsPeakItsEndAndItsGrowth) {
  const results::ResourceMetrics figures = resource_metrics(rows_of_a_run());
  EXPECT_EQ(figures.map.peak_bytes, 100'000.0);
  EXPECT_NEAR(figures.map.growth_bytes_per_s, 10'000.0, 1e-6);
  EXPECT_NEAR(figures.map.growth_r_squared, 1.0, 1e-9);
  EXPECT_LT(figures.backlog.growth_r_squared, 0.1);
  EXPECT_EQ(figures.scan_buffer.peak_bytes, 500.0);
  EXPECT_NEAR(figures.scan_buffer.growth_bytes_per_s, 0.0, 1e-9);
  EXPECT_EQ(figures.backlog.peak_bytes, 7777.0);
  EXPECT_EQ(figures.backlog.final_bytes, 0.0);
  EXPECT_EQ(figures.own.peak_bytes, 100'500.0);
  EXPECT_EQ(figures.rss.final_bytes, 50'100'000.0);
  EXPECT_EQ(figures.pss.peak_bytes, 40'100'000.0);
}

TEST(Resources, OverTimeKeepsEveryPeak) {
  const results::ResourceMetrics metrics = resource_metrics(rows_of_a_run(), 10);
  const results::ResourcesOverTime& curves = metrics.over_time;
  EXPECT_EQ(curves.largest_of, 10U);
  EXPECT_EQ(curves.t_s.size(), 10U);
  EXPECT_EQ(curves.backlog_bytes[3], 7777U);
  EXPECT_EQ(curves.latency_s[0], 0.15);
  EXPECT_EQ(curves.latency_s[1], 0.02);
}

TEST(Resources, OfARunWithoutScansAreEmptyAndOfOneScanKnown) {
  EXPECT_TRUE(resource_metrics({}).empty());
  dataset::ResourceRow row;
  row.t_sensor_s = 0.1;
  row.latency_s = 0.05;
  const results::ResourceMetrics figures = resource_metrics(std::vector{row});
  EXPECT_DOUBLE_EQ(figures.real_time_factor, 2.0);
  EXPECT_EQ(figures.late_scans, 0.0);
  EXPECT_EQ(figures.rss.growth_bytes_per_s, 0.0);
}

}  // namespace
}  // namespace lidarena::evaluation
