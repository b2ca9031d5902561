// SPDX-License-Identifier: BSD-3-Clause
#include "apps/lidarena/console.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <cstdio>
#include <utility>

namespace lidarena {
namespace {

constexpr auto kTerminalPeriod = std::chrono::milliseconds(200);
constexpr auto kLogPeriod = std::chrono::seconds(15);
constexpr int kBarWidth = 24;

std::string bar(double share) {
  const int filled = static_cast<int>(share * kBarWidth);
  return std::string(static_cast<std::size_t>(filled), '#') +
         std::string(static_cast<std::size_t>(kBarWidth - filled), '.');
}

/// Writes to standard error. Where that is impossible (a full disk, a closed pipe), the work goes
/// on.
template <class... Values>
void print(fmt::format_string<Values...> format, Values&&... values) {
  const std::string text = fmt::format(format, std::forward<Values>(values)...);
  std::fwrite(text.data(), 1, text.size(), stderr);
}

}  // namespace

std::string clock_text(double seconds) {
  const int s = static_cast<int>(seconds + 0.5);
  if (s >= 3600) return fmt::format("{}:{:02}:{:02}", s / 3600, s / 60 % 60, s % 60);
  return fmt::format("{}:{:02}", s / 60, s % 60);
}

Console::Console(bool quiet) : quiet_(quiet), terminal_(isatty(STDERR_FILENO) == 1) {}

void Console::erase_line() {
  if (line_open_) print("\r\x1b[K");
  line_open_ = false;
}

void Console::message(LogLevel level, std::string_view text) {
  if (quiet_ && level == LogLevel::kInfo) return;
  erase_line();
  print("{}{}\n", level == LogLevel::kWarning ? "warning: " : "", text);
}

void Console::progress(std::string_view stage, double done, double total) {
  if (quiet_) return;
  const auto now = Clock::now();
  const bool is_new = stage != stage_;
  if (is_new) {
    stage_ = stage;
    stage_begin_ = last_shown_ = now;
  }
  const bool finished = total > 0 && done >= total;
  const double elapsed = std::chrono::duration<double>(now - stage_begin_).count();
  if (finished) {
    erase_line();
    if (elapsed > 1.0) print("  {}: done in {}\n", stage, clock_text(elapsed));
    stage_.clear();
    return;
  }
  if (now - last_shown_ < (terminal_ ? Clock::duration(kTerminalPeriod) : kLogPeriod)) return;
  last_shown_ = now;
  const double share = total > 0 ? done / total : 0.0;
  const std::string left =
      share > 0.01 ? clock_text(elapsed * (1.0 - share) / share) + " left" : "estimating";
  if (terminal_) {
    print("\r\x1b[K  {} [{}] {:3.0f} %  {}", stage, bar(share), 100 * share, left);
    std::fflush(stderr);
    line_open_ = true;
  } else {
    print("  {}: {:.0f} %, {}\n", stage, 100 * share, left);
  }
}

}  // namespace lidarena
