// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/odometry/pacer.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "lidarena/base/time.hpp"

namespace lidarena::odometry {
namespace {

using testing::ElementsAre;

/// A scan of a tenth of a second that ends at `end_s`.
Event scan_ending_at(double end_s) {
  Scan scan;
  scan.stamp = from_seconds(end_s - 0.1);
  Point last;
  last.dt_ns = 100'000'000;
  scan.points = {Point{}, last};
  return {"lidar", scan};
}

Event imu_at(double t_s) {
  ImuSample sample;
  sample.stamp = from_seconds(t_s);
  return {"imu", sample};
}

/// Scans at 0.1, 0.2, ... s, each after the IMU sample of its last point.
std::vector<std::string> handed_over(Pacer& pacer, std::vector<std::string>& log, int scans) {
  for (int i = 1; i <= scans; ++i) {
    pacer.offer(imu_at(0.1 * i));
    pacer.offer(scan_ending_at(0.1 * i));
  }
  pacer.flush();
  return log;
}

/// Appends each event to `log` and reports that each scan took `seconds`.
Pacer::Process taking(double seconds, std::vector<std::string>& log) {
  return [seconds, &log](const Event& event) {
    const auto* scan = std::get_if<Scan>(&event.data);
    const Time t = scan != nullptr ? end_of(*scan) : std::get<ImuSample>(event.data).stamp;
    log.push_back((scan != nullptr ? "scan " : "imu ") + std::to_string(t.count() / 100'000'000));
    return scan != nullptr ? seconds : 0.0;
  };
}

TEST(Pacer, KeepsEveryScanWhenTheAlgorithmIsFastEnough) {
  std::vector<std::string> log;
  Pacer pacer(taking(0.099, log));
  EXPECT_THAT(handed_over(pacer, log, 3),
              ElementsAre("imu 1", "scan 1", "imu 2", "scan 2", "imu 3", "scan 3"));
  EXPECT_EQ(pacer.dropped(), 0U);
  EXPECT_NEAR(pacer.longest_delay_s(), 0.099, 1e-9);
}

TEST(Pacer, DropsAllButTheNewestScanWhenLate) {
  std::vector<std::string> log;
  // Scan 1 takes until 0.45 s. Of scans 2, 3, 4 the last is processed, until 0.80 s; of 5, 6, 7 the
  // last.
  Pacer pacer(taking(0.35, log));
  EXPECT_THAT(handed_over(pacer, log, 7),
              ElementsAre("imu 1", "scan 1", "imu 2", "imu 3", "imu 4", "scan 4", "imu 5", "imu 6",
                          "imu 7", "scan 7"));
  EXPECT_EQ(pacer.dropped(), 4U);
}

TEST(Pacer, DelayCountsTheWaitAndTheWork) {
  std::vector<std::string> log;
  // Scan 1 ends at 0.1 s and is processed until 0.25 s; then scan 2, which arrived at 0.2 s,
  // starts.
  Pacer pacer(taking(0.15, log));
  handed_over(pacer, log, 2);
  EXPECT_EQ(pacer.dropped(), 0U);
  EXPECT_NEAR(pacer.longest_delay_s(), 0.20, 1e-9);
}

TEST(Pacer, ImuSamplesKeepTheirPlaceBehindAScanThatWaits) {
  std::vector<std::string> log;
  Pacer pacer(taking(0.15, log));
  pacer.offer(scan_ending_at(0.1));
  pacer.offer(scan_ending_at(0.2));  // waits until 0.25 s
  pacer.offer(imu_at(0.3));
  EXPECT_THAT(log, ElementsAre("scan 1"));
  pacer.flush();
  EXPECT_THAT(log, ElementsAre("scan 1", "scan 2", "imu 3"));
}

}  // namespace
}  // namespace lidarena::odometry
