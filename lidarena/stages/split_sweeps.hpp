// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <deque>
#include <memory>
#include <string>

#include "lidarena/base/event.hpp"

namespace lidarena::stages {

/// The events of another source, with each sweep of one LiDAR as several scans, one after the
/// other: of equal length by the times of the points, which keep their order. A part is delivered
/// after the IMU samples up to its own end, as EventSource demands. An empty sweep stays one scan.
class SplitSweeps final : public EventSource {
 public:
  /// `parts`: of each sweep, at least 1.
  SplitSweeps(std::unique_ptr<EventSource> source, std::string lidar_id, int parts);

  /// Throws InputError at a sweep whose points have no times.
  std::optional<Event> next() override;

 private:
  void hand_over(Event sweep);
  void hand_over_imu_until(Time end);

  std::unique_ptr<EventSource> source_;
  std::string lidar_id_;
  int parts_;
  std::deque<Event> held_;   ///< since the last sweep
  std::deque<Event> ready_;  ///< to be returned
  Time last_imu_{Time::min()};
};

}  // namespace lidarena::stages
