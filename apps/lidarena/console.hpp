// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <string>

#include "lidarena/base/log.hpp"

namespace lidarena {

/// Messages and progress on standard error: one line rewritten in place on a terminal, a plain line
/// now and then in a log.
class Console : public LogSink {
 public:
  explicit Console(bool quiet);
  void message(LogLevel level, std::string_view text) override;
  void progress(std::string_view stage, double done, double total) override;

 private:
  using Clock = std::chrono::steady_clock;
  void erase_line();

  bool quiet_;
  bool terminal_;
  bool line_open_ = false;  ///< an unfinished progress line stands on the terminal
  std::string stage_;
  Clock::time_point stage_begin_;
  Clock::time_point last_shown_;
};

/// 75.2 -> "1:15", 4000 -> "1:06:40".
std::string clock_text(double seconds);

}  // namespace lidarena
