// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>

#include "lidarena/base/config_json.hpp"

namespace lidarena::study {

/// The program `lidarena` that does the tasks of a study: `given`, else the one beside this
/// process's own program, else the one in PATH. Throws InputError if there is none.
std::filesystem::path find_program(const std::filesystem::path& given);

/// What the program says of itself (`lidarena --version --json`): its version, and a hash of the
/// code of the simulator, of the scorer and of each method. A result depends on these and on its
/// inputs alone.
class ProgramCode {
 public:
  /// As a plan holds it, see json().
  explicit ProgramCode(Json code) : code_(std::move(code)) {}
  /// Asks the program. Throws InputError if it gives no answer, Error if it
  /// was killed.
  static ProgramCode ask(const std::filesystem::path& program);

  const Json& json() const { return code_; }
  /// Version and hash of "simulator" or "scorer".
  Json of(const std::string& part) const;
  /// Version and hash of an algorithm; for an external program, of what surrounds it.
  Json of_method(const std::string& algorithm) const;

 private:
  Json code_;
};

}  // namespace lidarena::study
