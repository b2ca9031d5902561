// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <deque>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "lidarena/base/time.hpp"
#include "lidarena/dataset/event.hpp"

namespace lidarena {

/// Keeps the promise of EventSource for measurements that come in whatever order a file has them:
/// a scan is given out only once each of the IMUs has given a sample at or after the scan's last
/// point. IMU samples pass at once; scans wait, and leave in the order they came. What already
/// keeps the promise passes unchanged. At the end (finish()) the scans that still wait are given
/// out: there is no later sample to wait for.
///
/// Throws InputError when a sensor's time does not increase (IMU samples may repeat a stamp), and
/// when an IMU lags more than `kLongestGap` behind the scans: waiting on would fill the memory.
class StreamMerge {
 public:
  static constexpr Time kLongestGap = std::chrono::seconds(5);

  /// `imu_ids` are the IMUs to wait for; `place` names the file in messages.
  StreamMerge(std::string place, const std::vector<std::string>& imu_ids);

  void push(Event event);
  /// No more events will come.
  void finish();
  /// The next event that may be given out; empty if more must be pushed first.
  std::optional<Event> pop();

 private:
  void push_imu(Event event);
  void push_scan(Event event);
  void release();
  void fail_backwards(const Event& event, Time previous, Time stamp) const;

  std::string place_;
  std::map<std::string, Time> covered_;  ///< latest sample of each IMU waited for
  // An IMU may have the id of the LiDAR it is built into.
  std::map<std::string, Time> latest_imu_;
  std::map<std::string, Time> latest_scan_;
  std::deque<std::pair<Time, Event>> waiting_;  ///< scans and their last points' times
  std::deque<Event> ready_;
};

}  // namespace lidarena
