// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>

#include "lidarena/base/config_json.hpp"
#include "lidarena/stages/simulate_dataset.hpp"

namespace lidarena::live {

/// Options of `simulate --live`.
struct LiveSimulation {
  bool asked = false;
  double rate = 1.0;
  double wait_s = 1.0;
  bool sensors_only = false;
  int domain = -1;
  bool network = false;
};

/// What was simulated and published.
struct PublishedFlight {
  stages::SimulateSummary summary;
  Json messages;     ///< counts, see PacedWriter::summary()
  std::string text;  ///< the same in a sentence
};

/// Writes the dataset folder `out` without measurements, then publishes these while they are
/// simulated, until the end of the flight or Ctrl-C.
PublishedFlight simulate_live(const LiveSimulation& live, stages::SimulateRequest request,
                              const std::filesystem::path& out, const Parallel& parallel,
                              LogSink& log);

}  // namespace lidarena::live
