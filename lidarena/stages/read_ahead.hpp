// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <condition_variable>
#include <cstddef>
#include <deque>
#include <exception>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>

#include "lidarena/base/event.hpp"

namespace lidarena::stages {

/// The events of another source, taken from it by a thread of its own, some scans ahead of those
/// that were returned. What the source throws is thrown by next() after the events before it.
class ReadAhead final : public EventSource {
 public:
  /// `scans`: how many may wait to be returned.
  explicit ReadAhead(std::unique_ptr<EventSource> source, std::size_t scans = 5);
  /// Waits for the event that the source is about to return.
  ~ReadAhead() override;

  std::optional<Event> next() override;

 private:
  void read();

  std::unique_ptr<EventSource> source_;
  std::size_t max_scans_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<Event> waiting_;
  std::size_t scans_ = 0;  ///< in waiting_
  bool finished_ = false;
  bool stopped_ = false;
  std::exception_ptr failure_;
  std::thread thread_;
};

}  // namespace lidarena::stages
