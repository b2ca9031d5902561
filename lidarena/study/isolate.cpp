// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/study/isolate.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sched.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <exception>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <thread>

#include "lidarena/base/error.hpp"

namespace lidarena::study {
namespace {

namespace fs = std::filesystem;

constexpr auto kPollPeriod = std::chrono::milliseconds(20);
constexpr auto kUsagePeriod = std::chrono::milliseconds(250);  // reads all of /proc, hence rarely

[[noreturn]] void child(const std::function<void()>& work, int reason_fd) {
  std::string reason;
  try {
    work();
  } catch (const std::exception& e) {
    reason = e.what();
    if (reason.empty()) reason = "an exception without a message";
  }
  std::fflush(nullptr);
  for (std::size_t sent = 0; sent < reason.size();) {
    const ssize_t n = write(reason_fd, reason.data() + sent, reason.size() - sent);
    if (n <= 0) break;
    sent += static_cast<std::size_t>(n);
  }
  _exit(reason.empty() ? 0 : 1);
}

void use_only(const std::vector<int>& cores) {
  if (cores.empty()) return;
  cpu_set_t set;
  CPU_ZERO(&set);
  for (const int core : cores) CPU_SET(static_cast<std::size_t>(core), &set);
  sched_setaffinity(0, sizeof set, &set);  // failure is harmless: the load is less even
}

struct Usage {
  double busy_s = 0.0;
  double resident_mb = 0.0;
};

/// The values used of one process's line in /proc/PID/stat.
struct ProcessLine {
  int group = 0;
  double busy_s = 0.0;
  double resident_mb = 0.0;
};

/// Empty if the process has ended.
std::optional<ProcessLine> process_line(const fs::path& folder) {
  std::ifstream file(folder / "stat");
  std::string line;
  if (!std::getline(file, line)) return std::nullopt;
  const std::size_t end_of_name = line.rfind(')');  // the name may contain any character
  if (end_of_name == std::string::npos) return std::nullopt;
  std::istringstream fields(line.substr(end_of_name + 1));
  // Fields 3 to 24 of proc(5): state ppid pgrp ... utime stime cutime cstime ... rss.
  char state = 0;
  std::array<double, 21> number{};
  fields >> state;
  for (double& n : number) fields >> n;
  if (!fields) return std::nullopt;
  static const auto kTicks = static_cast<double>(sysconf(_SC_CLK_TCK));
  static const auto kPage = static_cast<double>(sysconf(_SC_PAGESIZE));
  return ProcessLine{static_cast<int>(number[1]),
                     (number[10] + number[11] + number[12] + number[13]) / kTicks,
                     number[20] * kPage * 1e-6};
}

/// Processor time and memory of all processes of a group.
Usage usage_of_group(int group) {
  Usage usage;
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator("/proc", ignored)) {
    const std::string name = entry.path().filename();
    if (name.find_first_not_of("0123456789") != std::string::npos) continue;
    const auto process = process_line(entry.path());
    if (!process || process->group != group) continue;
    usage.busy_s += process->busy_s;
    usage.resident_mb += process->resident_mb;
  }
  return usage;
}

std::string reason_of_end(int status, const std::string& end_message) {
  if (WIFSIGNALED(status)) {
    const int signal = WTERMSIG(status);
    return fmt::format("killed by signal {} ({}{})", signal, strsignal(signal),
                       signal == SIGKILL ? ", perhaps out of memory" : "");
  }
  return end_message.empty() ? fmt::format("exit code {}", WEXITSTATUS(status)) : end_message;
}

}  // namespace

IsolatedWork::IsolatedWork(const std::function<void()>& work, const WorkLimits& limits,
                           const std::vector<int>& cores)
    : limits_(limits) {
  std::array<int, 2> ends{};
  if (pipe2(ends.data(), O_CLOEXEC) != 0) throw Error(std::string("pipe: ") + std::strerror(errno));
  std::fflush(nullptr);
  const pid_t parent = getpid();
  pid_ = fork();
  if (pid_ < 0) throw Error(std::string("fork: ") + std::strerror(errno));
  if (pid_ == 0) {
    setpgid(0, 0);
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (getppid() != parent) _exit(1);  // the parent ended before prctl()
    use_only(cores);
    close(ends[0]);
    child(work, ends[1]);
  }
  setpgid(pid_, pid_);  // set by both processes, since either may run first
  close(ends[1]);
  reason_fd_ = ends[0];
  fcntl(reason_fd_, F_SETFL, O_NONBLOCK);
}

IsolatedWork::~IsolatedWork() {
  if (pid_ > 0) {
    kill(-pid_, SIGKILL);
    while (waitpid(pid_, nullptr, 0) < 0 && errno == EINTR) {
    }
  }
  close(reason_fd_);
}

void IsolatedWork::read_reason() {
  std::array<char, 4096> buffer{};
  for (;;) {
    const ssize_t n = read(reason_fd_, buffer.data(), buffer.size());
    if (n > 0) reason_.append(buffer.data(), static_cast<std::size_t>(n));
    if (n == 0 || (n < 0 && errno != EINTR)) return;
  }
}

/// A message naming the limit that the work has exceeded; empty if none.
std::string IsolatedWork::exceeded_limit() {
  const auto now = Clock::now();
  const double seconds = std::chrono::duration<double>(now - begin_).count();
  if (limits_.seconds > 0 && seconds > limits_.seconds) {
    return fmt::format("stopped: not finished within its time limit of {:.0f} s", limits_.seconds);
  }
  if (limits_.memory_mb <= 0 && limits_.stall_seconds <= 0) return {};
  if (now - last_usage_check_ < kUsagePeriod) return {};
  last_usage_check_ = now;
  const Usage usage = usage_of_group(pid_);
  if (limits_.memory_mb > 0 && usage.resident_mb > limits_.memory_mb) {
    return fmt::format("stopped: it used {:.0f} MB, more than its limit of {:.0f} MB",
                       usage.resident_mb, limits_.memory_mb);
  }
  if (usage.busy_s > busy_s_ + 0.01 * limits_.stall_seconds || usage.busy_s < busy_s_) {
    busy_s_ = usage.busy_s;
    last_busy_ = now;
  }
  const double idle = std::chrono::duration<double>(now - last_busy_).count();
  if (limits_.stall_seconds > 0 && idle > limits_.stall_seconds) {
    return fmt::format("stopped: it stalled, with almost no processor time used for {:.0f} s",
                       limits_.stall_seconds);
  }
  return {};
}

std::optional<IsolatedOutcome> IsolatedWork::poll() {
  read_reason();
  int status = 0;
  const pid_t ended = waitpid(pid_, &status, WNOHANG);
  if (ended == pid_) {
    read_reason();         // what it wrote just before it ended
    kill(-pid_, SIGKILL);  // ends processes that it left running
    pid_ = -1;
    if (WIFEXITED(status) && WEXITSTATUS(status) == 0) return IsolatedOutcome{true, ""};
    return IsolatedOutcome{false, reason_of_end(status, reason_)};
  }
  const std::string passed = exceeded_limit();
  if (passed.empty()) return std::nullopt;
  kill(-pid_, SIGKILL);
  while (waitpid(pid_, &status, 0) < 0 && errno == EINTR) {
  }
  pid_ = -1;
  return IsolatedOutcome{false, passed};
}

IsolatedOutcome run_isolated(const std::function<void()>& work, const WorkLimits& limits) {
  IsolatedWork isolated(work, limits);
  for (;;) {
    if (auto outcome = isolated.poll()) return *outcome;
    std::this_thread::sleep_for(kPollPeriod);
  }
}

std::vector<int> usable_cores() {
  std::vector<int> cores;
  cpu_set_t set;
  CPU_ZERO(&set);
  if (sched_getaffinity(0, sizeof set, &set) == 0) {
    for (int core = 0; core < CPU_SETSIZE; ++core) {
      if (CPU_ISSET(static_cast<std::size_t>(core), &set)) cores.push_back(core);
    }
  }
  if (cores.empty()) cores.push_back(0);
  return cores;
}

}  // namespace lidarena::study
