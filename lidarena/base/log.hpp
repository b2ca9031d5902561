// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string_view>

namespace lidarena {

enum class LogLevel { kInfo, kWarning };

/// Receives the library's messages and progress. There is no global sink: callers pass one to the
/// functions that report. The default implementation discards everything.
class LogSink {
 public:
  virtual ~LogSink() = default;
  virtual void message(LogLevel, std::string_view /*text*/) {}
  /// `done` of `total` units of the work named `stage`; total 0 when unknown. Called from one
  /// thread at a time.
  virtual void progress(std::string_view /*stage*/, double /*done*/, double /*total*/) {}

  void info(std::string_view text) { message(LogLevel::kInfo, text); }
  void warn(std::string_view text) { message(LogLevel::kWarning, text); }
};

}  // namespace lidarena
