// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/base/shell_word.hpp"

#include <gtest/gtest.h>

#include <cstdio>

namespace lidarena {
namespace {

/// What a shell makes of the command line `command`.
std::string output_of(const std::string& command) {
  std::string text;
  std::FILE* pipe = popen(command.c_str(), "r");
  for (int c = std::fgetc(pipe); c != EOF; c = std::fgetc(pipe)) text += static_cast<char>(c);
  pclose(pipe);
  return text;
}

TEST(ShellWord, ReachesAProgramUnchangedWhateverItHolds) {
  for (const std::string word :
       {"",     "plain", "a b",         "it's",      "'",     "\"", "$(id)",
        "`id`", "a|b",   "a;b",         "a&b",       "a>b",   "#a", "~",
        "*",    "!x",    "back\\slash", "new\nline", "{a,b}", "-n", "mühle"}) {
    EXPECT_EQ(output_of("printf %s " + shell_word(word)), word);
  }
}

TEST(ShellWord, IsNotQuotedWithoutNeed) {
  EXPECT_EQ(shell_word("configs/sensors/my-lidar_1.yaml"), "configs/sensors/my-lidar_1.yaml");
  EXPECT_EQ(shell_word("my lidar"), "'my lidar'");
}

}  // namespace
}  // namespace lidarena
