// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <functional>
#include <optional>
#include <utility>
#include <vector>

#include "lidarena/odometry/odometry.hpp"
#include "tests/odometry/synthetic_room.hpp"

/// Feeding an odometry with the synthetic room's events and judging what it returns.
namespace lidarena::odometry::synthetic {

struct Outcome {
  std::vector<ScanResult> results;

  std::size_t count(ScanStatus status) const {
    return static_cast<std::size_t>(std::count_if(
        results.begin(), results.end(), [&](const ScanResult& r) { return r.status == status; }));
  }
  template <class T>
  T largest(std::optional<T> ScanCounters::*counter) const {
    T value{};
    for (const ScanResult& r : results)
      value = std::max(value, (r.counters.*counter).value_or(T{}));
    return value;
  }
  double largest_detail(std::string_view name) const {
    double value = 0.0;
    for (const ScanResult& r : results) value = std::max(value, r.detail(name).value_or(0.0));
    return value;
  }
  /// Error (m) of the last pose relative to the first one.
  double final_error(const Recording& recording) const {
    const StampedPose& first = results.front().estimate;
    const StampedPose& last = results.back().estimate;
    const Pose moved = first.world_from_body.inverse() * last.world_from_body;
    return (moved.translation() - truth(recording, first.stamp, last.stamp).translation()).norm();
  }
};

inline Outcome play(const std::vector<Event>& events, Odometry& odometry) {
  Outcome outcome;
  for (const Event& event : events) {
    if (const auto* scan = std::get_if<Scan>(&event.data)) {
      outcome.results.push_back(odometry.register_scan(*scan));
    } else {
      odometry.register_imu(std::get<ImuSample>(event.data));
    }
  }
  return outcome;
}

/// The events of the default recording.
inline const std::vector<Event>& usual_events() {
  static const std::vector<Event> events = record({});
  return events;
}

/// The events with `change` applied to each IMU sample; without the samples for which it returns
/// false.
inline std::vector<Event> with_imu(const std::function<bool(ImuSample&)>& change,
                                   const std::vector<Event>& events = usual_events()) {
  std::vector<Event> changed;
  for (Event event : events) {
    auto* sample = std::get_if<ImuSample>(&event.data);
    if (sample == nullptr || change(*sample)) changed.push_back(std::move(event));
  }
  return changed;
}

}  // namespace lidarena::odometry::synthetic
