// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <deque>
#include <functional>

#include "lidarena/dataset/event.hpp"

namespace lidarena {

/// Hands events over as a live robot would: an algorithm that is late finds only the newest scan
/// waiting, the ones before it are dropped; IMU samples are never dropped. Nobody sleeps: the time
/// that the algorithm took is laid on the sensors' clock, where a scan comes with its last point.
class Pacer {
 public:
  /// Takes one event up and returns the seconds that this took.
  using Process = std::function<double(const Event&)>;
  explicit Pacer(Process process) : process_(std::move(process)) {}

  /// One event of the algorithm's own sensors, in the order of EventSource.
  void offer(Event event);
  /// Nothing else comes: hands over what waits.
  void flush();

  std::size_t dropped() const { return dropped_; }
  /// Longest time from a scan's last point to its estimate, s.
  double longest_delay_s() const { return longest_delay_s_; }

 private:
  void hand_over();
  void drop_waiting_scan();

  Process process_;
  std::deque<Event> waiting_;  ///< at most one scan among them, as the first
  Time free_{Time::min()};     ///< when the algorithm is done with what it has
  std::size_t dropped_ = 0;
  double longest_delay_s_ = 0.0;
};

}  // namespace lidarena
