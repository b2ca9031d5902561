// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <deque>
#include <functional>

#include "lidarena/base/event.hpp"

namespace lidarena::odometry {

/// Hands over events at the pace of a live robot: if the algorithm is late, only the newest waiting
/// scan is kept and older ones are dropped; IMU samples are never dropped. Nothing sleeps: the
/// computing time is added to the sensors' clock, on which a scan arrives with its last point.
class Pacer {
 public:
  /// Processes one event and returns the time that this took, s.
  using Process = std::function<double(const Event&)>;
  explicit Pacer(Process process) : process_(std::move(process)) {}

  /// Takes the next event of the algorithm's own sensors, in the order of EventSource.
  void offer(Event event);
  /// Call after the last event: hands over the events that still wait.
  void flush();

  std::size_t dropped() const { return dropped_; }
  /// Longest time from a scan's last point to its estimate, s.
  double longest_delay_s() const { return longest_delay_s_; }

 private:
  void hand_over();
  void drop_waiting_scan();

  Process process_;
  std::deque<Event> waiting_;  ///< at most one scan, which then is the first element
  Time free_{Time::min()};     ///< when the algorithm has processed what it was handed
  std::size_t dropped_ = 0;
  double longest_delay_s_ = 0.0;
};

}  // namespace lidarena::odometry
