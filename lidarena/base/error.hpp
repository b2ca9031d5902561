// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <stdexcept>
#include <string>
#include <string_view>

namespace lidarena {

/// An operation failed (exit code 1 on the command line).
class Error : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Bad input from outside (exit code 2). Its text is "place: what is wrong; remedy".
class InputError : public Error {
 public:
  /// `place` is a file, "file:line", or the name of what was given; `remedy` may be empty.
  InputError(std::string_view place, std::string_view what, std::string_view remedy = {})
      : Error(compose(place, what, remedy)) {}

 private:
  static std::string compose(std::string_view place, std::string_view what,
                             std::string_view remedy) {
    std::string text{place};
    text.append(": ").append(what);
    if (!remedy.empty()) text.append("; ").append(remedy);
    return text;
  }
};

}  // namespace lidarena
