// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <CLI/CLI.hpp>
#include <string>

#include "adapters/dds/participant.hpp"

namespace lidarena {

/// Adds --domain and --network to a verb with live topics.
void add_live_options(CLI::App& verb, dds::LiveOptions& options);

/// Adds a topic's name to a verb, which is then given with a slash in front.
CLI::Option* add_topic_option(CLI::App& verb, const std::string& name, std::string& topic,
                              const std::string& what);

/// From now on Ctrl-C does not end the program; the returned function says whether it was asked to
/// end.
bool (*end_on_interrupt())();

}  // namespace lidarena
