// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

#include "lidarena/base/imu_sample.hpp"
#include "lidarena/base/scan.hpp"
#include "lidarena/dataset/run_events.hpp"
#include "lidarena/odometry/odometry.hpp"

namespace lidarena::stages {

/// The body turns fast: a typical scan of 0.1 s is smeared by 6 deg.
constexpr double kFastTurnDegS = 60.0;
/// Samples of the IMU that are farther apart have a gap; at 100 Hz four are missing.
constexpr Time kImuGap = std::chrono::milliseconds(50);

/// Collects what happens during a run that explains its error. What lasts is one event as long as
/// it pauses for less than 0.1 s. The same input gives the same events.
class EventRecord {
 public:
  /// The next sample of the run's IMU. Fast turns are those of its gyroscope.
  void add(const ImuSample& sample);
  /// What the method says of the next scan. Without an IMU, turns are those of its estimates.
  void add(const Scan& scan, const odometry::ScanResult& result);
  /// All so far, in the order of their times, which are since `first_scan`.
  std::vector<dataset::RunEvent> events(Time first_scan) const;

 private:
  struct Span {
    Time begin{0}, end{0};
    double value = 0.0;
  };
  /// Extends the last span of the kind or begins a new one.
  void add_span(dataset::RunEventKind kind, Span span);
  void add_instant(dataset::RunEventKind kind, Time at, double value);
  void add_turn(Time begin, Time end, double rate_rad_s);
  void add_counted(dataset::RunEventKind kind, const odometry::ScanCounters::Count& count, Time at,
                   std::uint64_t& known);

  std::vector<Span> spans_[dataset::kRunEvents.size()];
  std::optional<Time> last_sample_;
  std::optional<StampedPose> last_estimate_;
  std::size_t scans_ = 0;
  std::uint64_t loops_ = 0, restarts_ = 0;
};

}  // namespace lidarena::stages
