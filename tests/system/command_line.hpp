// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>
#include <sys/wait.h>

#include <array>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

#include "tests/temporary_folder.hpp"

/// Shared by the tests of the program: calling it in a temporary folder, and a room to fly through.
namespace lidarena::testing {

namespace fs = std::filesystem;

struct Outcome {
  int exit_code = -1;
  std::string out;
  std::string err;
};

inline std::string content(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

inline bool same(const fs::path& a, const fs::path& b) { return content(a) == content(b); }

/// Each test has a temporary folder, deleted when the test ends.
class Cli : public ::testing::Test {
 protected:
  /// Calls the program in the test's folder.
  Outcome call(const std::string& arguments) const {
    const std::string command = "cd " + folder_.path().string() + " && " + LIDARENA_BINARY + " " +
                                arguments + " >out 2>err </dev/null";
    const int status = std::system(command.c_str());
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, content(path("out")),
            content(path("err"))};
  }
  /// Calls the program with bad input; expects exit code 2 and one error line, which it returns.
  std::string refusal(const std::string& arguments) const {
    const Outcome outcome = call(arguments);
    EXPECT_EQ(outcome.exit_code, 2) << arguments << "\n" << outcome.err;
    std::string last;
    int errors = 0;
    std::istringstream lines(outcome.err);
    for (std::string line; std::getline(lines, line);) {
      if (line.rfind("lidarena: ", 0) != 0) continue;
      ++errors;
      last = line;
    }
    EXPECT_EQ(errors, 1) << outcome.err;
    return last;
  }
  std::string write(const std::string& name, const std::string& text) const {
    return folder_.write(name, text).string();
  }
  std::string path(const std::string& name) const { return (folder_.path() / name).string(); }

  TemporaryFolder folder_;
};

/// A closed room of 12 x 8 x 4 m with one corner at the origin and two pillars, as OBJ.
inline std::string room_obj() {
  std::string obj;
  int base = 1;
  const auto box = [&](double x0, double y0, double z0, double x1, double y1, double z1) {
    std::ostringstream o;
    for (const double z : {z0, z1}) {
      for (const auto& [x, y] : {std::pair{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}}) {
        o << "v " << x << " " << y << " " << z << "\n";
      }
    }
    constexpr std::array<std::array<int, 4>, 6> kFaces{
        {{1, 4, 3, 2}, {5, 6, 7, 8}, {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 4, 8, 7}, {4, 1, 5, 8}}};
    for (const auto& f : kFaces) {
      o << "f";
      for (const int i : f) o << " " << base + i - 1;
      o << "\n";
    }
    base += 8;
    obj += o.str();
  };
  box(0, 0, 0, 12, 8, 4);
  box(4, 3, 0, 4.6, 3.6, 4);
  box(8, 5, 0, 8.6, 5.6, 4);
  return obj;
}

inline constexpr const char* kRoomFlight =
    "# A round between the pillars of the test room.\n"
    "kind: waypoints\n"
    "waypoints: [[2, 2, 1.5], [10, 2, 1.2], [10, 7, 1.8], [2, 6.5, 1.5], [2, 2, 1.5]]\n";

}  // namespace lidarena::testing
