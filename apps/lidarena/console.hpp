// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <string>

#include "lidarena/base/log.hpp"

namespace lidarena {

/// Writes messages and progress to standard error. Progress on a terminal is one line that is
/// rewritten in place, elsewhere a plain line every 15 s.
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
  bool line_open_ = false;  ///< the terminal shows an unfinished progress line
  std::string stage_;
  Clock::time_point stage_begin_;
  Clock::time_point last_shown_;
};

/// 75.2 -> "1:15", 4000 -> "1:06:40".
std::string clock_text(double seconds);

}  // namespace lidarena
