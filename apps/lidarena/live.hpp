// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <CLI/CLI.hpp>

#include "adapters/dds/participant.hpp"

namespace lidarena {

/// Adds --domain and --network to a verb with live topics.
void add_live_options(CLI::App& verb, dds::LiveOptions& options);

/// From now on Ctrl-C does not end the program; the returned function says whether it was asked to
/// end.
bool (*end_on_interrupt())();

}  // namespace lidarena
