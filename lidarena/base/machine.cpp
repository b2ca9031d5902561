// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/base/machine.hpp"

#include <fstream>
#include <sstream>
#include <thread>

namespace lidarena {
namespace {

/// Text after the colon of the first line of `file` that begins with `key`; empty if there is none.
std::string entry(const char* file, const std::string& key) {
  std::ifstream lines(file);
  for (std::string line; std::getline(lines, line);) {
    if (!line.starts_with(key)) continue;
    const std::size_t value = line.find_first_not_of(" \t", line.find(':') + 1);
    return value == std::string::npos ? "" : line.substr(value);
  }
  return "";
}

}  // namespace

Machine this_machine() {
  Machine machine;
  if (std::string name = entry("/proc/cpuinfo", "model name"); !name.empty()) {
    machine.processor = std::move(name);
  }
  machine.cores = static_cast<int>(std::thread::hardware_concurrency());
  double kilobytes = 0.0;
  if (std::istringstream(entry("/proc/meminfo", "MemTotal")) >> kilobytes) {
    machine.memory_gib = kilobytes / (1024.0 * 1024.0);
  }
  return machine;
}

}  // namespace lidarena
