// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <CLI/CLI.hpp>
#include <string>

#include "adapters/dds/participant.hpp"
#include "adapters/live/record_run.hpp"

namespace lidarena {

/// Adds --domain and --network to a verb with live topics.
void add_live_options(CLI::App& verb, dds::LiveOptions& options);

/// Adds a topic's name to a verb, which is then given with a slash in front.
CLI::Option* add_topic_option(CLI::App& verb, const std::string& name, std::string& topic,
                              const std::string& what);

/// Options of `record --truth`.
void add_run_to_record(CLI::App& verb, live::RunToRecord& run);

}  // namespace lidarena
