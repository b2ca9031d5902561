// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <CLI/CLI.hpp>
#include <string>

#include "adapters/live/run_live.hpp"
#include "adapters/live/simulate_live.hpp"

namespace lidarena {

/// Options of `run --live` and of `simulate --live`, if this build has live topics.
void add_live_run(CLI::App& verb, live::LiveRun& run);
void add_live_simulation(CLI::App& verb, live::LiveSimulation& live);

}  // namespace lidarena
