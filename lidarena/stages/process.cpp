// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/stages/process.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sched.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <map>
#include <sstream>
#include <thread>

#include "lidarena/base/error.hpp"
#include "lidarena/dataset/text_file.hpp"

namespace lidarena::stages {
namespace {

namespace fs = std::filesystem;

constexpr auto kUsagePeriod = std::chrono::milliseconds(250);  // reads all of /proc, hence rarely

/// Opens `file` for appending; an empty path stands for /dev/null.
int open_output(const fs::path& file) {
  const fs::path place = file.empty() ? fs::path("/dev/null") : file;
  const int fd = open(place.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0644);
  if (fd < 0) throw Error(place.string() + ": cannot be created: " + std::strerror(errno));
  return fd;
}

cpu_set_t set_of(const std::vector<int>& cores) {
  cpu_set_t set;
  CPU_ZERO(&set);
  for (const int core : cores) CPU_SET(static_cast<std::size_t>(core), &set);
  return set;
}

/// All that the new process needs, prepared by the caller: between fork() and exec() only system
/// calls are allowed, since other threads may hold locks.
struct Prepared {
  std::vector<char*> arguments;
  int output = -1, log = -1;
  cpu_set_t cores{};
  bool all_cores = true;
  bool own_group = true;
  pid_t parent = -1;
};

[[noreturn]] void become(const Prepared& prepared) {
  if (prepared.own_group) setpgid(0, 0);
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (getppid() != prepared.parent) _exit(1);  // the parent ended before prctl()
  if (!prepared.all_cores) sched_setaffinity(0, sizeof prepared.cores, &prepared.cores);
  dup2(prepared.output, STDOUT_FILENO);
  dup2(prepared.log, STDERR_FILENO);
  close_range(3, ~0U, CLOSE_RANGE_CLOEXEC);
  execv(prepared.arguments.front(), prepared.arguments.data());
  _exit(127);
}

pid_t start(const Command& command) {
  std::vector<std::string> words = command.arguments;
  Prepared prepared;
  for (std::string& word : words) prepared.arguments.push_back(word.data());
  prepared.arguments.push_back(nullptr);
  prepared.output = open_output(command.output);
  prepared.log = open_output(command.log);
  prepared.cores = set_of(command.cores);
  prepared.all_cores = command.cores.empty();
  prepared.own_group = command.own_group;
  prepared.parent = getpid();
  const pid_t pid = fork();
  if (pid == 0) become(prepared);
  const int error = errno;
  close(prepared.output);
  close(prepared.log);
  if (pid < 0) throw Error(std::string("fork: ") + std::strerror(error));
  if (command.own_group) setpgid(pid, pid);  // by both processes, since either may run first
  return pid;
}

struct Usage {
  double busy_s = 0.0;
  double resident_mb = 0.0;
};

/// The values used of one process's line in /proc/PID/stat.
struct ProcessLine {
  int parent = 0;
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
  return ProcessLine{static_cast<int>(number[0]), static_cast<int>(number[1]),
                     (number[10] + number[11] + number[12] + number[13]) / kTicks,
                     number[20] * kPage * 1e-6};
}

/// All processes by their ids.
std::map<int, ProcessLine> all_processes() {
  std::map<int, ProcessLine> processes;
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator("/proc", ignored)) {
    const std::string name = entry.path().filename();
    if (name.find_first_not_of("0123456789") != std::string::npos) continue;
    if (const auto process = process_line(entry.path())) processes[std::stoi(name)] = *process;
  }
  return processes;
}

/// Processor time and memory of all processes of a group.
Usage usage_of_group(int group) {
  Usage usage;
  for (const auto& [id, process] : all_processes()) {
    if (process.group != group) continue;
    usage.busy_s += process.busy_s;
    usage.resident_mb += process.resident_mb;
  }
  return usage;
}

/// A process, those that it started, those that these started, and so on.
std::vector<int> tree_of(int root) {
  const std::map<int, ProcessLine> processes = all_processes();
  std::vector<int> tree{root};
  for (std::size_t i = 0; i < tree.size(); ++i) {
    for (const auto& [id, process] : processes) {
      if (process.parent == tree[i]) tree.push_back(id);
    }
  }
  return tree;
}

/// Whether a process runs; not one that has ended and that nobody has waited for.
bool is_running(int process) {
  std::ifstream file(fmt::format("/proc/{}/stat", process));
  std::string line;
  if (!std::getline(file, line)) return false;
  const std::size_t state = line.rfind(')') + 2;  // no name's end: 1, the state is not 'Z' then
  return state < line.size() && line[state] != 'Z' && line[state] != 'X';
}

/// The last line of a log that is not empty, without the program's name before an error.
std::string last_line(const fs::path& log) {
  std::ifstream file(log);
  std::string last;
  for (std::string line; std::getline(file, line);) {
    if (!line.empty()) last = line;
  }
  constexpr std::string_view kProgram = "lidarena: ";
  return last.starts_with(kProgram) ? last.substr(kProgram.size()) : last;
}

double seconds_of(const timeval& time) {
  return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
}

}  // namespace

Process::Process(const Command& command, const ProcessLimits& limits)
    : pid_(start(command)), own_group_(command.own_group), log_(command.log), limits_(limits) {}

Process::~Process() {
  if (pid_ <= 0) return;
  kill(id_to_kill(), SIGKILL);
  while (waitpid(pid_, nullptr, 0) < 0 && errno == EINTR) {
  }
}

std::string Process::reason_of_end(int status) const {
  if (WIFSIGNALED(status)) {
    const int signal = WTERMSIG(status);
    return fmt::format("killed by signal {} ({}{})", signal, strsignal(signal),
                       signal == SIGKILL ? ", perhaps out of memory" : "");
  }
  if (WEXITSTATUS(status) == 0) return {};
  const std::string said = log_.empty() ? std::string() : last_line(log_);
  return said.empty() ? fmt::format("exit code {}", WEXITSTATUS(status)) : said;
}

/// A message naming the limit that the process has exceeded; empty if none.
std::string Process::exceeded_limit() {
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

std::optional<ProcessEnd> Process::poll() {
  int status = 0;
  rusage used{};
  ProcessEnd end;
  if (wait4(pid_, &status, WNOHANG, &used) == pid_) {
    end.reason = reason_of_end(status);
    if (WIFEXITED(status)) end.exit_code = WEXITSTATUS(status);
    if (own_group_) kill(id_to_kill(), SIGKILL);  // ends processes that it left running
  } else {
    end.reason = exceeded_limit();
    if (end.reason.empty()) return std::nullopt;
    kill(id_to_kill(), SIGKILL);
    while (wait4(pid_, &status, 0, &used) < 0 && errno == EINTR) {
    }
  }
  pid_ = -1;
  end.processor_s = seconds_of(used.ru_utime) + seconds_of(used.ru_stime);
  end.peak_mb = 1e-3 * static_cast<double>(used.ru_maxrss);
  return end;
}

ProcessEnd Process::wait() {
  for (;;) {
    if (auto end = poll()) return *end;
    std::this_thread::sleep_for(kPollPeriod);
  }
}

ProcessEnd Process::stop(std::chrono::milliseconds grace) {
  const std::vector<int> tree = tree_of(pid_);
  for (const int process : tree) kill(process, SIGINT);
  const auto end = Clock::now() + grace;
  const auto runs = [](int process) { return is_running(process); };
  while (Clock::now() < end && std::ranges::any_of(tree, runs))
    std::this_thread::sleep_for(kPollPeriod);
  for (const int process : tree) {
    if (runs(process)) kill(process, SIGKILL);
  }
  return wait();
}

Answer answer_of(Command command, const ProcessLimits& limits) {
  std::string name = (fs::temp_directory_path() / "lidarena-answer-XXXXXX").string();
  const int fd = mkstemp(name.data());
  if (fd < 0) throw Error(name + ": cannot be created: " + std::strerror(errno));
  close(fd);
  command.output = name;
  Answer answer;
  answer.end = Process(command, limits).wait();
  answer.text = dataset::read_bytes(name);
  fs::remove(name);
  return answer;
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

}  // namespace lidarena::stages
