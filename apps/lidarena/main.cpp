// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <cstdio>
#include <exception>

#include "apps/lidarena/shell_help.hpp"
#include "apps/lidarena/verbs.hpp"
#include "lidarena/base/error.hpp"

namespace lidarena {

study::ConfigFolder Common::config_folder() const {
  if (!configs.empty()) return study::ConfigFolder(configs);
  try {
    return study::ConfigFolder::find(std::filesystem::current_path());
  } catch (const InputError&) {
    return study::ConfigFolder::find(std::filesystem::read_symlink("/proc/self/exe").parent_path());
  }
}

void set_verb(CLI::App& verb, Common& common, std::function<int()> action, int& exit_code) {
  verb.add_flag("--json", common.json,
                "One JSON document on standard output, all else on standard error");
  verb.add_flag("--quiet,-q", common.quiet, "Print only warnings and errors");
  verb.add_option("--threads", common.threads, "Number of threads, 0 = one per core")
      ->check(CLI::NonNegativeNumber);
  verb.add_option("--configs", common.configs, "Folder of the named worlds, flights, sensors, ...")
      ->check(CLI::ExistingDirectory);
  verb.callback([action = std::move(action), &exit_code] { exit_code = action(); });
}

void print_json(const Json& json) { fmt::print("{}\n", json.dump(2)); }

namespace {

/// Version and build options, which distinguish builds of the same version.
std::string version_text() { return "lidarena " LIDARENA_VERSION "\n" LIDARENA_BUILD_FACTS; }

void add_text(CLI::App& app, const std::string& name, const std::string& what,
              std::string (*make)(const CLI::App&)) {
  app.add_subcommand(name, what)->callback([&app, make] { fmt::print("{}", make(app)); });
}

int parse_and_do(int argc, char** argv) {
  CLI::App app{
      "Lidarena: which LiDAR, and which SLAM, for my robot?\n"
      "Simulates LiDARs on a flying quadcopter in mesh worlds, runs SLAM on their scans, and\n"
      "scores odometry and map against the mesh that was scanned.\n\n"
      "Step by step:\n"
      "  lidarena simulate --world house --flight house --sensor livox_mid360 --out my_data\n"
      "  lidarena run kiss_icp my_data --out my_run\n"
      "  lidarena evaluate my_run\n"
      "or with one command, which also writes a report page:\n"
      "  lidarena study quick --out my_study\n",
      "lidarena"};
  app.set_version_flag("--version", version_text());
  app.require_subcommand(1);
  app.failure_message(CLI::FailureMessage::simple);
  Common common;
  int exit_code = kDone;
  add_list(app, common, exit_code);
  add_info(app, common, exit_code);
  add_simulate(app, common, exit_code);
  add_run(app, common, exit_code);
  add_evaluate(app, common, exit_code);
  add_study(app, common, exit_code);
  add_report(app, common, exit_code);
  add_convert(app, common, exit_code);
  add_view(app, common, exit_code);
  add_schema(app, common, exit_code);
  add_text(app, "completion", "Print a completion script for bash: source <(lidarena completion)",
           bash_completion);
  add_text(app, "man", "Print the manual page: lidarena man | man -l -", man_page);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& e) {
    return app.exit(e) == 0 ? kDone : kBadInput;
  }
  return exit_code;
}

}  // namespace
}  // namespace lidarena

int main(int argc, char** argv) {
  try {
    return lidarena::parse_and_do(argc, argv);
  } catch (const lidarena::InputError& e) {
    fmt::print(stderr, "lidarena: {}\n", e.what());
    return lidarena::kBadInput;
  } catch (const std::exception& e) {
    fmt::print(stderr, "lidarena: {}\n", e.what());
    return lidarena::kWorkFailed;
  }
}
