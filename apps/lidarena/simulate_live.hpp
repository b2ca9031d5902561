// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>

#include "lidarena/base/config_json.hpp"
#include "lidarena/study/simulate_dataset.hpp"

namespace lidarena {

/// Options of `simulate --live`.
struct LiveSimulation {
  bool asked = false;
  double rate = 1.0;
  double wait_s = 1.0;
  bool sensors_only = false;
  int domain = -1;
  bool network = false;
};

/// Adds them to `simulate`, if this build has live topics.
void add_live_simulation(CLI::App& verb, LiveSimulation& live);

/// What was simulated and published.
struct PublishedFlight {
  study::SimulateSummary summary;
  Json messages;     ///< counts, see PacedWriter::summary()
  std::string text;  ///< the same in a sentence
};

/// Writes the dataset folder `out` without measurements, then publishes these while they are
/// simulated, until the end of the flight or Ctrl-C.
PublishedFlight simulate_live(const LiveSimulation& live, study::SimulateRequest request,
                              const std::filesystem::path& out, const Parallel& parallel,
                              LogSink& log);

}  // namespace lidarena
