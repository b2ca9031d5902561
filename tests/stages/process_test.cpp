// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/stages/process.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <thread>

#include "lidarena/dataset/text_file.hpp"
#include "tests/temporary_folder.hpp"

namespace lidarena::stages {
namespace {

using std::chrono::milliseconds;

Command shell(const std::string& script) {
  Command command;
  command.arguments = {"/bin/sh", "-c", script};
  command.own_group = false;
  return command;
}

/// Waits until a file has a line.
int number_in(const std::filesystem::path& file) {
  for (int i = 0; i < 500; ++i) {
    if (std::filesystem::exists(file)) {
      const std::string text = dataset::read_bytes(file);
      if (text.ends_with('\n')) return std::stoi(text);
    }
    std::this_thread::sleep_for(milliseconds(10));
  }
  ADD_FAILURE() << file << " was not written";
  return -1;
}

/// False also of one that has ended and that its parent has not waited for.
bool is_alive(int process) {
  const std::filesystem::path file = "/proc/" + std::to_string(process) + "/stat";
  if (!std::filesystem::exists(file)) return false;
  std::ifstream in(file);
  std::string line;
  std::getline(in, line);
  return !line.empty() && line.find(") Z") == std::string::npos;
}

TEST(Process, ThatIsAskedToEndMayFinishItsWork) {
  const TemporaryFolder folder;
  const auto file = folder.path() / "end";
  Process process(shell("trap 'echo 1 > " + file.string() + "; exit 7' INT; echo 1 > " +
                        (folder.path() / "begin").string() + "; while :; do sleep 0.05; done"));
  number_in(folder.path() / "begin");
  const ProcessEnd end = process.stop(milliseconds(10'000));
  EXPECT_EQ(end.exit_code, 7);
  EXPECT_EQ(number_in(file), 1);
}

TEST(Process, ThatDoesNotEndIsKilledWithThoseThatItStarted) {
  const TemporaryFolder folder;
  const auto file = folder.path() / "child";
  Process process(shell("trap '' INT; sh -c 'echo $$ > " + file.string() + "; exec sleep 100'; :"));
  const int child = number_in(file);
  ASSERT_TRUE(is_alive(child));
  const auto begin = std::chrono::steady_clock::now();
  const ProcessEnd end = process.stop(milliseconds(300));
  EXPECT_EQ(end.exit_code, -1);
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(20));
  for (int i = 0; i < 500 && is_alive(child); ++i)
    std::this_thread::sleep_for(milliseconds(10));  // until the signal has arrived
  EXPECT_FALSE(is_alive(child));
}

}  // namespace
}  // namespace lidarena::stages
