// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace lidarena {

/// What figures of time were taken on.
struct Machine {
  std::string processor = "a processor of unknown name";
  int cores = 1;            ///< logical ones
  double memory_gib = 0.0;  ///< 0 if unknown
};

Machine this_machine();

}  // namespace lidarena
