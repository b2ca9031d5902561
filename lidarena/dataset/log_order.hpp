// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <optional>
#include <utility>
#include <vector>

#include "lidarena/base/event.hpp"

namespace lidarena::dataset {

/// Gives out events in the order of their log times (as players do), where a file holds them in
/// another order within a bounded look-ahead. Events of equal log time keep their order.
class LogOrder {
 public:
  explicit LogOrder(Time look_ahead) : look_ahead_(look_ahead) {}

  void push(Time log_time, Event event) {
    latest_ = std::max(latest_, log_time);
    const auto place = std::ranges::upper_bound(waiting_, log_time, {}, &Waiting::first);
    waiting_.emplace(place, log_time, std::move(event));
  }
  /// The next event that is `look_ahead` older than the latest one; after finish() any.
  std::optional<Event> pop() {
    const bool is_ready =
        !waiting_.empty() && (finished_ || waiting_.front().first <= latest_ - look_ahead_);
    if (!is_ready) return std::nullopt;
    Event event = std::move(waiting_.front().second);
    waiting_.erase(waiting_.begin());
    return event;
  }
  void finish() { finished_ = true; }

 private:
  using Waiting = std::pair<Time, Event>;
  Time look_ahead_;
  Time latest_ = Time::min();
  bool finished_ = false;
  std::vector<Waiting> waiting_;  ///< by log time: some scans, and the samples between them
};

}  // namespace lidarena::dataset
