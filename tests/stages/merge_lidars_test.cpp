// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/stages/merge_lidars.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "lidarena/base/error.hpp"
#include "tests/listed_sources.hpp"

namespace lidarena::stages {
namespace {

using std::chrono::milliseconds;

LidarInfo up() {
  LidarInfo lidar;
  lidar.id = "up";
  lidar.body_from_lidar.translation() = Eigen::Vector3d(0.0, 0.0, 0.1);
  return lidar;
}

/// Upside down, 0.2 m below the other.
LidarInfo down() {
  LidarInfo lidar;
  lidar.id = "down";
  lidar.body_from_lidar.linear() = Eigen::DiagonalMatrix<double, 3>(1.0, -1.0, -1.0);
  lidar.body_from_lidar.translation() = Eigen::Vector3d(0.0, 0.0, -0.1);
  return lidar;
}

Event imu(int ms) {
  ImuSample sample;
  sample.stamp = milliseconds(ms);
  return {"imu", sample};
}

/// A sweep of 100 ms with a point every 10 ms, each 3 m ahead, 1 m left and 2 m above; its ring is
/// the number of the point.
Event sweep(const char* id, int ms) {
  Scan scan;
  scan.stamp = milliseconds(ms);
  for (int i = 0; i < 10; ++i) {
    Point point;
    point.position = {3.0F, 1.0F, 2.0F};
    point.dt_ns = i * 10'000'000;
    point.ring = static_cast<std::uint16_t>(ms / 10 + i);
    scan.points.push_back(point);
  }
  return {id, scan};
}

/// Three sweeps of each; those of `down` begin 35 ms later.
std::vector<Event> recording() {
  constexpr int kLate = 35;
  std::vector<Event> events;
  for (int ms = 0; ms <= 340; ms += 5) {
    events.push_back(imu(ms));
    if (ms > 0 && ms % 100 == 0) events.push_back(sweep("up", ms - 100));
    if (ms > kLate && (ms - kLate) % 100 == 0) events.push_back(sweep("down", ms - 100));
  }
  return events;
}

std::vector<Event> merged(const std::vector<Event>& events) {
  MergeLidars source(std::make_unique<listed::Events>(events), up(), {down()});
  std::vector<Event> all;
  while (auto event = source.next()) all.push_back(std::move(*event));
  return all;
}

std::vector<Scan> scans_of(const std::vector<Event>& events) {
  std::vector<Scan> scans;
  for (const Event& event : events)
    if (const auto* scan = std::get_if<Scan>(&event.data)) scans.push_back(*scan);
  return scans;
}

TEST(MergeLidars, GivesThePointsInTheFrameOfTheFirstLidarWithTheirOrigins) {
  const std::vector<Scan> scans = scans_of(merged(recording()));
  ASSERT_EQ(scans.size(), 3U);
  ASSERT_EQ(scans[1].origins.size(), 2U);
  for (const Point& point : scans[1].points) {
    const bool is_other = point.lidar == 1;
    const Eigen::Vector3f expected =
        is_other ? Eigen::Vector3f(3.0F, -1.0F, -2.2F) : Eigen::Vector3f(3.0F, 1.0F, 2.0F);
    EXPECT_TRUE(point.position.isApprox(expected, 1e-6F)) << point.position.transpose();
    EXPECT_TRUE(origin_of(scans[1], point)
                    .isApprox(Eigen::Vector3f(0.0F, 0.0F, is_other ? -0.2F : 0.0F), 1e-6F));
  }
}

TEST(MergeLidars, GivesEachPointOnceAtItsTimeToTheFirstScanThatEndsNoEarlier) {
  const std::vector<Scan> scans = scans_of(merged(recording()));
  std::vector<int> of_down;
  Time last = Time::min();
  for (const Scan& scan : scans) {
    EXPECT_EQ(std::ranges::count(scan.points, 0, &Point::lidar), 10);
    for (const Point& point : scan.points) {
      EXPECT_GE(time_of(scan, point), last);
      last = time_of(scan, point);
      if (point.lidar == 0) continue;
      of_down.push_back(point.ring);
      EXPECT_EQ(last, milliseconds(10 * point.ring + 5)) << "sweeps begin at 35 ms, not at 30";
    }
  }
  std::vector<int> all;  // the last scan ends at 290 ms
  for (int i = 3; 10 * i + 5 <= 290; ++i) all.push_back(i);
  EXPECT_EQ(of_down, all);
}

TEST(MergeLidars, KeepsTheOrderOfSamplesAndScans) {
  Time latest = Time::min();
  std::size_t samples = 0;
  for (const Event& event : merged(recording())) {
    if (const auto* sample = std::get_if<ImuSample>(&event.data)) {
      EXPECT_GT(sample->stamp, latest);
      latest = sample->stamp;
      ++samples;
    } else {
      EXPECT_GE(latest, end_of(std::get<Scan>(event.data)));
    }
  }
  EXPECT_EQ(samples, 69U);
}

TEST(MergeLidars, DoesNotWaitForALidarThatIsSilent) {
  std::vector<Event> events = recording();
  for (int ms = 300; ms < 1000; ms += 100) events.push_back(sweep("up", ms));
  EXPECT_EQ(scans_of(merged(events)).size(), 10U);
}

TEST(MergeLidars, LeavesOutWhatWasMeasuredBeforeTheFirstScan) {
  std::vector<Event> events{sweep("down", 0), sweep("down", 100), sweep("down", 200),
                            sweep("up", 250), sweep("down", 300)};
  const std::vector<Scan> scans = scans_of(merged(events));
  ASSERT_EQ(scans.size(), 1U);
  EXPECT_EQ(scans[0].stamp, milliseconds(160));
  EXPECT_EQ(scans[0].points.size(), 10U + 19U);
}

TEST(MergeLidars, RefusesPointsWithoutTimes) {
  std::vector<Event> events = recording();
  for (Event& event : events)
    if (auto* scan = std::get_if<Scan>(&event.data); scan && event.sensor_id == "down")
      scan->timed = false;
  EXPECT_THROW(merged(events), InputError);
}

}  // namespace
}  // namespace lidarena::stages
