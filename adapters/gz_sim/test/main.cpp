// SPDX-License-Identifier: BSD-3-Clause
// The tests' servers find the plugins, and hear nobody else.
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <string>

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  const std::string partition = "lidarena_" + std::to_string(::getpid());
  for (const char* prefix : {"IGN", "GZ"}) {
    ::setenv((std::string(prefix) + "_PARTITION").c_str(), partition.c_str(), 1);
    ::setenv((std::string(prefix) + "_IP").c_str(), "127.0.0.1", 1);
  }
  ::setenv("IGN_GAZEBO_SYSTEM_PLUGIN_PATH", LIDARENA_PLUGIN_PATH, 1);
  ::setenv("GZ_SIM_SYSTEM_PLUGIN_PATH", LIDARENA_PLUGIN_PATH, 1);
  return RUN_ALL_TESTS();
}
