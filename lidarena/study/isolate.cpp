// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/study/isolate.hpp"

#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <exception>

#include "lidarena/base/error.hpp"

namespace lidarena {
namespace {

std::string read_all(int fd) {
  std::string text;
  std::array<char, 4096> buffer{};
  for (;;) {
    const ssize_t n = read(fd, buffer.data(), buffer.size());
    if (n > 0) text.append(buffer.data(), static_cast<std::size_t>(n));
    if (n == 0 || (n < 0 && errno != EINTR)) return text;
  }
}

[[noreturn]] void child(const std::function<void()>& work, int report_fd) {
  std::string reason;
  try {
    work();
  } catch (const std::exception& e) {
    reason = e.what();
    if (reason.empty()) reason = "an error without a text";
  }
  std::fflush(nullptr);
  for (std::size_t sent = 0; sent < reason.size();) {
    const ssize_t n = write(report_fd, reason.data() + sent, reason.size() - sent);
    if (n <= 0) break;
    sent += static_cast<std::size_t>(n);
  }
  _exit(reason.empty() ? 0 : 1);
}

}  // namespace

IsolatedOutcome run_isolated(const std::function<void()>& work) {
  std::array<int, 2> ends{};
  if (pipe(ends.data()) != 0) throw Error(std::string("pipe: ") + std::strerror(errno));
  std::fflush(nullptr);
  const pid_t pid = fork();
  if (pid < 0) throw Error(std::string("fork: ") + std::strerror(errno));
  if (pid == 0) {
    close(ends[0]);
    child(work, ends[1]);
  }
  close(ends[1]);
  std::string reason = read_all(ends[0]);
  close(ends[0]);
  int status = 0;
  while (waitpid(pid, &status, 0) < 0 && errno == EINTR) {
  }
  if (WIFEXITED(status) && WEXITSTATUS(status) == 0) return {true, ""};
  if (WIFSIGNALED(status)) {
    const int signal = WTERMSIG(status);
    reason = std::string("killed by signal ") + std::to_string(signal) + " (" + strsignal(signal) +
             (signal == SIGKILL ? ", perhaps out of memory)" : ")");
  } else if (reason.empty()) {
    reason = "exit code " + std::to_string(WEXITSTATUS(status));
  }
  return {false, reason};
}

}  // namespace lidarena
