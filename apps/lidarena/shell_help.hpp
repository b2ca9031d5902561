// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <CLI/CLI.hpp>
#include <string>

namespace lidarena {

/// The program's manual page (troff, section 1), generated from the verbs and options of `app`.
std::string man_page(const CLI::App& app);

/// Completion script for bash (and for zsh after `bashcompinit`), generated likewise. It completes
/// verbs, options, the values that an option allows, and the names of worlds, flights, sensors,
/// algorithms and studies.
std::string bash_completion(const CLI::App& app);

}  // namespace lidarena
