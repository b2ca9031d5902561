// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/stages/read_ahead.hpp"

#include <utility>

namespace lidarena::stages {
namespace {

bool is_scan(const Event& event) { return std::holds_alternative<Scan>(event.data); }

}  // namespace

ReadAhead::ReadAhead(std::unique_ptr<EventSource> source, std::size_t scans)
    : source_(std::move(source)), max_scans_(scans), thread_([this] { read(); }) {}

ReadAhead::~ReadAhead() {
  {
    const std::lock_guard lock(mutex_);
    stopped_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

std::optional<Event> ReadAhead::next() {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [&] { return !waiting_.empty() || finished_; });
  if (waiting_.empty()) {
    if (failure_) std::rethrow_exception(failure_);
    return std::nullopt;
  }
  Event event = std::move(waiting_.front());
  waiting_.pop_front();
  if (is_scan(event)) --scans_;
  lock.unlock();
  changed_.notify_all();
  return event;
}

void ReadAhead::read() {
  try {
    while (auto event = source_->next()) {
      std::unique_lock lock(mutex_);
      changed_.wait(lock, [&] { return scans_ < max_scans_ || stopped_; });
      if (stopped_) return;
      if (is_scan(*event)) ++scans_;
      waiting_.push_back(*std::move(event));
      lock.unlock();
      changed_.notify_all();
    }
  } catch (...) {
    failure_ = std::current_exception();
  }
  const std::lock_guard lock(mutex_);
  finished_ = true;
  changed_.notify_all();
}

}  // namespace lidarena::stages
