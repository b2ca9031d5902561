// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>

#include "lidarena/base/error.hpp"
#include "lidarena/base/log.hpp"

/// What a reader of worlds complains of: warnings and errors.
namespace lidarena::testing {

/// Keeps the warnings.
class RecordingLog : public LogSink {
 public:
  void message(LogLevel level, std::string_view text) override {
    if (level == LogLevel::kWarning) warnings.append(text).append("\n");
  }
  std::string warnings;
};

/// What `action` throws as InputError, as text; empty when it throws none.
template <class Action>
std::string input_error_of(Action&& action) {
  try {
    action();
  } catch (const InputError& error) {
    return error.what();
  }
  return {};
}

}  // namespace lidarena::testing
