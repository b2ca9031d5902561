// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>

#include "lidarena/base/error.hpp"
#include "lidarena/base/log.hpp"

/// Helpers that capture the warnings and errors of loading a world.
namespace lidarena::world::testing {

/// Collects the warnings.
class RecordingLog : public LogSink {
 public:
  void message(LogLevel level, std::string_view text) override {
    if (level == LogLevel::kWarning) warnings.append(text).append("\n");
  }
  std::string warnings;
};

/// Text of the InputError that `action` throws; empty when it throws none.
template <class Action>
std::string input_error_of(Action&& action) {
  try {
    action();
  } catch (const InputError& error) {
    return error.what();
  }
  return {};
}

}  // namespace lidarena::world::testing
