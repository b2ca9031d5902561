// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <condition_variable>
#include <deque>
#include <functional>
#include <mutex>
#include <thread>
#include <utility>

namespace lidarena::gazebo_plugin {

/// Executes jobs one after the other on a thread of its own. add() blocks while too many jobs are
/// pending, so no job is dropped and memory stays bounded.
class StepThread {
 public:
  StepThread() : thread_([this] { run(); }) {}
  ~StepThread() {
    {
      const std::lock_guard lock(mutex_);
      ends_ = true;
    }
    changed_.notify_all();
    thread_.join();
  }
  void add(std::function<void()> job) {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return jobs_.size() < kMaxPending; });
    jobs_.push_back(std::move(job));
    changed_.notify_all();
  }
  /// Returns once all jobs are done.
  void drain() {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return jobs_.empty(); });
  }

 private:
  static constexpr std::size_t kMaxPending = 200;  // jobs (steps)

  void run() {
    std::unique_lock lock(mutex_);
    for (;;) {
      changed_.wait(lock, [this] { return ends_ || !jobs_.empty(); });
      if (jobs_.empty()) return;
      const std::function<void()>& job = jobs_.front();  // remains in the queue until it is done
      lock.unlock();
      job();
      lock.lock();
      jobs_.pop_front();
      changed_.notify_all();
    }
  }

  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<std::function<void()>> jobs_;
  bool ends_ = false;
  std::thread thread_;  // the last member: it uses the others
};

}  // namespace lidarena::gazebo_plugin
