// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <deque>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "lidarena/base/event.hpp"
#include "lidarena/base/time.hpp"
#include "lidarena/dataset/read_report.hpp"

namespace lidarena::dataset {

/// Brings measurements, in whatever order a file stores them, into the order that EventSource
/// guarantees: a scan is released only once each of the IMUs has delivered a sample at or after the
/// scan's last point. IMU samples are released immediately; scans wait, and are released in the
/// order of their arrival. Input that is already in this order stays unchanged. finish() releases
/// the scans that still wait: there is no later sample to wait for.
///
/// Without a report, it throws InputError when the times of a sensor do not increase (IMU samples
/// may repeat a stamp), and when an IMU lags more than `kMaxGap` behind the scans: waiting longer
/// would fill the memory. With one, measurements that are not later than the one before are left
/// out and counted, and the caller looks at lagging().
class StreamMerge {
 public:
  static constexpr Time kMaxGap = std::chrono::seconds(5);

  /// `imu_ids` are the IMUs to wait for; `place` names the file in messages.
  StreamMerge(std::string place, const std::vector<std::string>& imu_ids,
              ReadReport* report = nullptr);

  void push(Event event);
  /// No more events will come.
  void finish();
  /// The next released event; empty if more must be pushed first.
  std::optional<Event> pop();

  /// Whether scans wait for IMU samples.
  bool is_waiting() const { return !waiting_.empty(); }
  /// The IMU that is more than `gap` behind the scans; empty if none is.
  std::optional<std::string> lagging(Time gap = kMaxGap) const;
  /// Stamp of the latest sample of an IMU; Time::min() without one.
  Time latest_imu(const std::string& id) const;
  /// No scan waits for this IMU any more. Returns the time up to which it has samples.
  Time give_up(const std::string& imu);

 private:
  void push_imu(Event event);
  void push_scan(Event event);
  void release();
  /// Leaves out and counts a measurement, or throws.
  void refuse(const Event& event, Time previous, Time stamp) const;

  std::string place_;
  ReadReport* report_;
  std::map<std::string, Time> covered_;  ///< time of the latest sample of each IMU waited for
  // An IMU may have the id of the LiDAR it is built into.
  std::map<std::string, Time> latest_imu_;
  std::map<std::string, Time> latest_scan_;
  std::deque<std::pair<Time, Event>> waiting_;  ///< scans with the times of their last points
  std::deque<Event> ready_;
};

}  // namespace lidarena::dataset
