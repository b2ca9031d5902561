// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace lidarena::stages {

/// How often the state of programs that run is looked at.
inline constexpr auto kPollPeriod = std::chrono::milliseconds(20);

/// A program to start.
struct Command {
  std::vector<std::string> arguments;  ///< its path first
  std::filesystem::path output;        ///< file that its standard output is added to; empty = none
  std::filesystem::path log;           ///< the same for its standard error
  std::vector<int> cores;              ///< processors that it may use; empty = all
  bool own_group = true;               ///< false: it belongs to the caller's process group
};

/// Limits of one process; 0 = no limit.
struct ProcessLimits {
  double seconds = 0.0;        ///< wall-clock time
  double memory_mb = 0.0;      ///< resident memory of all processes of its group together
  double stall_seconds = 0.0;  ///< of this time, it must use a processor for at least 1 %
};

/// How a process ended.
struct ProcessEnd {
  int exit_code = -1;        ///< -1: killed by a signal or stopped at a limit
  std::string reason;        ///< why the exit code is not 0, in words: the last line of its log
  double processor_s = 0.0;  ///< used by it and by the processes it waited for
  double peak_mb = 0.0;      ///< highest resident memory of any of these
};

/// A running process. With a group of its own, it and the processes that it starts end with this
/// object. It ends, too, when the thread that started it ends for any reason.
class Process {
 public:
  /// Throws Error if the process or its files cannot be created; a program that does not exist
  /// ends with exit code 127.
  explicit Process(const Command& command, const ProcessLimits& limits = {});
  ~Process();
  Process(const Process&) = delete;
  Process& operator=(const Process&) = delete;

  /// How it ended, else empty; never waits. Kills a process beyond its limits.
  std::optional<ProcessEnd> poll();
  /// Waits until it ends.
  ProcessEnd wait();
  /// Asks it and the processes that it started to end (SIGINT, as Ctrl-C does), waits for `grace`,
  /// and kills those that have not ended.
  ProcessEnd stop(std::chrono::milliseconds grace);

 private:
  using Clock = std::chrono::steady_clock;

  std::string exceeded_limit();
  std::string reason_of_end(int status) const;
  int id_to_kill() const { return own_group_ ? -pid_ : pid_; }

  int pid_ = -1;
  bool own_group_;
  std::filesystem::path log_;
  ProcessLimits limits_;
  Clock::time_point begin_ = Clock::now();
  double busy_s_ = 0.0;  ///< processor time when it was last seen to advance
  Clock::time_point last_busy_ = begin_;
  Clock::time_point last_usage_check_ = begin_;
};

/// What a program wrote to standard output, and how it ended.
struct Answer {
  ProcessEnd end;
  std::string text;
};
/// Runs a command to its end; its own `output` is not used.
Answer answer_of(Command command, const ProcessLimits& limits = {});

/// The processors that this process may use.
std::vector<int> usable_cores();

}  // namespace lidarena::stages
