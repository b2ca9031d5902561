// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/odometry/pacer.hpp"

#include <algorithm>

#include "lidarena/base/time.hpp"

namespace lidarena::odometry {

void Pacer::offer(Event event) {
  const auto* scan = std::get_if<Scan>(&event.data);
  if (scan == nullptr) {
    waiting_.push_back(std::move(event));
    if (!std::holds_alternative<Scan>(waiting_.front().data)) hand_over();
    return;
  }
  const Time arrival = end_of(*scan);
  if (free_ <= arrival) {
    hand_over();  // the waiting events were processed before this scan arrived
  } else {
    drop_waiting_scan();
  }
  waiting_.push_back(std::move(event));
  if (free_ <= arrival) hand_over();
}

void Pacer::flush() { hand_over(); }

void Pacer::hand_over() {
  for (; !waiting_.empty(); waiting_.pop_front()) {
    const double seconds = process_(waiting_.front());
    const auto* scan = std::get_if<Scan>(&waiting_.front().data);
    if (scan == nullptr) continue;
    const Time arrival = end_of(*scan);
    free_ = std::max(free_, arrival) + from_seconds(seconds);
    longest_delay_s_ = std::max(longest_delay_s_, to_seconds(free_ - arrival));
  }
}

void Pacer::drop_waiting_scan() {
  if (waiting_.empty() || !std::holds_alternative<Scan>(waiting_.front().data)) return;
  waiting_.pop_front();
  ++dropped_;
  // The IMU samples that followed the dropped scan are needed for the motion up to the next scan.
  for (; !waiting_.empty(); waiting_.pop_front()) process_(waiting_.front());
}

}  // namespace lidarena::odometry
