// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace lidarena::study {

/// Limits of one piece of work; 0 = no limit.
struct WorkLimits {
  double seconds = 0.0;        ///< wall-clock time
  double memory_mb = 0.0;      ///< resident memory of all its processes together
  double stall_seconds = 0.0;  ///< of this time, it must use a processor for at least 1 %
};

struct IsolatedOutcome {
  bool ok = false;
  std::string reason;  ///< why it failed, in words; empty when ok
};

/// Runs work in a separate process, so that a crash, a memory leak, an endless loop or a kill
/// signal ends only that process. It and the processes it starts form a process group that ends
/// with this object, or when the calling process ends for any reason. The caller must not have
/// started threads.
class IsolatedWork {
 public:
  /// Starts `work`; an exception counts as failure. `cores`: processors it may use, empty = all.
  explicit IsolatedWork(const std::function<void()>& work, const WorkLimits& limits = {},
                        const std::vector<int>& cores = {});
  ~IsolatedWork();
  IsolatedWork(const IsolatedWork&) = delete;
  IsolatedWork& operator=(const IsolatedWork&) = delete;

  /// The outcome once the work has ended, else empty; never waits. Kills work beyond its limits.
  std::optional<IsolatedOutcome> poll();

 private:
  using Clock = std::chrono::steady_clock;

  void read_reason();
  std::string exceeded_limit();

  int pid_ = -1;
  int reason_fd_ = -1;
  WorkLimits limits_;
  Clock::time_point begin_ = Clock::now();
  std::string reason_;
  double busy_s_ = 0.0;  ///< processor time when it was last seen to advance
  Clock::time_point last_busy_ = begin_;
  Clock::time_point last_usage_check_ = begin_;
};

/// Runs `work` in a separate process and waits until it ends.
IsolatedOutcome run_isolated(const std::function<void()>& work, const WorkLimits& limits = {});

/// The processors that this process may use.
std::vector<int> usable_cores();

}  // namespace lidarena::study
