// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace lidarena {

/// The computer on which run times were measured.
struct Machine {
  std::string processor = "unknown processor";
  int cores = 1;            ///< number of logical cores
  double memory_gib = 0.0;  ///< 0 if unknown
};

Machine this_machine();

}  // namespace lidarena
