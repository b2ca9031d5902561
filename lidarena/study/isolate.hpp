// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace lidarena {

/// What a piece of work may use; zero = no limit.
struct WorkLimits {
  double seconds = 0.0;        ///< by the wall clock
  double memory_mb = 0.0;      ///< resident, all its processes together
  double stall_seconds = 0.0;  ///< without using the processor for a hundredth of that time
};

struct IsolatedOutcome {
  bool ok = false;
  std::string reason;  ///< why it failed, in words; empty when ok
};

/// Work in a process of its own, so that a crash, a leak, an endless loop or a killer stops only
/// it. It and what it starts form a process group that ends with this object, or when the calling
/// process ends in whatever way. The caller must not have started threads.
class IsolatedWork {
 public:
  /// Starts `work`; an exception is its failure. `cores`: the processors it may use, none = all.
  explicit IsolatedWork(const std::function<void()>& work, const WorkLimits& limits = {},
                        const std::vector<int>& cores = {});
  ~IsolatedWork();
  IsolatedWork(const IsolatedWork&) = delete;
  IsolatedWork& operator=(const IsolatedWork&) = delete;

  /// How it ended, once it has; never waits. Stops it when it is beyond its limits.
  std::optional<IsolatedOutcome> poll();

 private:
  using Clock = std::chrono::steady_clock;

  void read_reason();
  std::string beyond_limits();

  int pid_ = -1;
  int reason_fd_ = -1;
  WorkLimits limits_;
  Clock::time_point begin_ = Clock::now();
  std::string reason_;
  double busy_s_ = 0.0;  ///< processor time when it was last seen to advance
  Clock::time_point last_busy_ = begin_;
  Clock::time_point last_look_ = begin_;
};

/// Does the work and waits for its end.
IsolatedOutcome run_isolated(const std::function<void()>& work, const WorkLimits& limits = {});

/// The processors that this process may use.
std::vector<int> usable_cores();

}  // namespace lidarena
