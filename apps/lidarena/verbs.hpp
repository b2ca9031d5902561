// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <string>

#include "lidarena/base/config_json.hpp"
#include "lidarena/stages/config_folder.hpp"

namespace lidarena {

/// Exit codes of the program.
inline constexpr int kDone = 0;
inline constexpr int kWorkFailed =
    1;                               ///< a run diverged, a study lacks cells, or an internal error
inline constexpr int kBadInput = 2;  ///< wrong usage or bad input
inline constexpr int kInterrupted = 75;  ///< `study`: asked to end; another call goes on

/// Options that every verb takes.
struct Common {
  bool json = false;
  bool quiet = false;
  int threads = 0;
  std::string configs;  ///< folder given with --configs; empty = search

  stages::ConfigFolder config_folder() const;
};

/// Adds --json, --quiet, --threads, --configs to `verb`. When the verb is parsed, runs `action` and
/// stores its result in `exit_code`.
void set_verb(CLI::App& verb, Common& common, std::function<int()> action, int& exit_code);

/// Adds --allow-missing to a verb that takes a world.
void add_allow_missing(CLI::App& verb, bool& allow_missing);

/// A name that nothing in the working folder has: `wanted`, else wanted-2, wanted-3, ...
std::string free_name(const std::string& wanted);

void add_list(CLI::App& app, Common& common, int& exit_code);
void add_check(CLI::App& app, Common& common, int& exit_code);
void add_improve(CLI::App& app, Common& common, int& exit_code);
void add_info(CLI::App& app, Common& common, int& exit_code);
void add_simulate(CLI::App& app, Common& common, int& exit_code);
void add_run(CLI::App& app, Common& common, int& exit_code);
void add_evaluate(CLI::App& app, Common& common, int& exit_code);
void add_study(CLI::App& app, Common& common, int& exit_code);
void add_status(CLI::App& app, Common& common, int& exit_code);
void add_convert(CLI::App& app, Common& common, int& exit_code);
void add_view(CLI::App& app, Common& common, int& exit_code);
void add_schema(CLI::App& app, Common& common, int& exit_code);
void add_report(CLI::App& app, Common& common, int& exit_code);
void add_play(CLI::App& app, Common& common, int& exit_code);
void add_record(CLI::App& app, Common& common, int& exit_code);

/// Prints one JSON document on standard output.
void print_json(const Json& json);

}  // namespace lidarena
