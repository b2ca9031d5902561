// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <csignal>
#include <cstdio>
#include <exception>
#include <string_view>

#include "apps/lidarena/code_hashes.hpp"
#include "apps/lidarena/origin.hpp"
#include "apps/lidarena/shell_help.hpp"
#include "apps/lidarena/verbs.hpp"
#include "lidarena/base/error.hpp"
#include "lidarena/odometry/factory.hpp"

namespace lidarena {

stages::ConfigFolder Common::config_folder() const {
  if (!configs.empty()) return stages::ConfigFolder(configs);
  try {
    return stages::ConfigFolder::find(std::filesystem::current_path());
  } catch (const InputError&) {
    return stages::ConfigFolder::find(
        std::filesystem::read_symlink("/proc/self/exe").parent_path());
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

void add_allow_missing(CLI::App& verb, bool& allow_missing) {
  verb.add_flag("--allow-missing", allow_missing,
                "Load an SDF world without the models and meshes that cannot be found");
}

std::string free_name(const std::string& wanted) {
  std::string name = wanted;
  for (int i = 2; std::filesystem::exists(name); ++i) name = fmt::format("{}-{}", wanted, i);
  return name;
}

void print_json(const Json& json) { fmt::print("{}\n", json.dump(2)); }

namespace {

/// Where this program comes from.
std::string origin() { return origin_of(std::filesystem::read_symlink("/proc/self/exe")); }

/// Version, origin and build options, which distinguish builds of the same version.
std::string version_text() {
  return fmt::format("lidarena {} from {}, commit {}\n{}", LIDARENA_VERSION, origin(), kCommit,
                     LIDARENA_BUILD_FACTS);
}

/// The hash of the method in whose folder an algorithm is: the folder with the longest name that
/// the algorithm's name begins with.
Json hash_of(const std::string& algorithm, const Json& by_folder) {
  std::string folder;
  for (const auto& [name, hash] : by_folder.items()) {
    if (algorithm.starts_with(name) && name.size() > folder.size()) folder = name;
  }
  return by_folder.at(folder);
}

/// Version, and hashes of the code that decides the results of each part of the program.
Json version_json() {
  Json code = Json::parse(kCodeHashes);
  const Json by_folder = code.at("methods");
  Json& methods = code["methods"] = {{"external", by_folder.at("external")}};
  for (const odometry::AlgorithmInfo& info : odometry::list_algorithms())
    methods[info.name] = hash_of(info.name, by_folder);
  return {{"version", LIDARENA_VERSION}, {"origin", origin()}, {"commit", kCommit}, {"code", code}};
}

/// Whether the arguments are --version and --json, in any order.
bool asks_for_version_json(int argc, char** argv) {
  if (argc != 3) return false;
  const std::string_view first = argv[1], second = argv[2];
  return (first == "--version" && second == "--json") ||
         (first == "--json" && second == "--version");
}

void add_text(CLI::App& app, const std::string& name, const std::string& what,
              std::string (*make)(const CLI::App&)) {
  app.add_subcommand(name, what)->callback([&app, make] { fmt::print("{}", make(app)); });
}

constexpr const char* kOverview =
    "Lidarena: which LiDAR, and which SLAM, for my robot?\n"
    "Simulates LiDARs on a flying quadcopter in mesh worlds, runs SLAM on their scans, and\n"
    "scores odometry and map against the mesh that was scanned.\n\n"
    "Three commands to begin with:\n"
    "  lidarena list sensors\n"
    "      the LiDARs: field of view, points, range, weight, power, price\n"
    "  lidarena study --world house --sensors livox_mid360,ouster_os0_32 --auto --seconds 10 --out "
    "my_study\n"
    "      which of them, and which SLAM, for this place; your own place: --world my.obj\n"
    "  lidarena run arena_lio my.bag\n"
    "      a SLAM on your own recording\n";

/// The program without a verb: what it is for and how to begin.
void print_overview(const CLI::App& app) {
  fmt::print("{}\nVerbs:", kOverview);
  for (const CLI::App* verb : app.get_subcommands([](const CLI::App*) { return true; }))
    fmt::print(" {}", verb->get_name());
  fmt::print(
      "\n`lidarena VERB --help` explains one, `lidarena --help` all; the first hour step by "
      "step: docs/first_hour.md\n");
}

int parse_and_do(int argc, char** argv) {
  if (asks_for_version_json(argc, argv)) {
    print_json(version_json());
    return kDone;
  }
  CLI::App app{kOverview, "lidarena"};
  CLI::Option* version = app.set_version_flag("--version", version_text());
  app.add_flag("--json")->needs(version)->description(
      "With --version: also hashes of the code of simulator, methods and scorer");
  app.require_subcommand(0, 1);
  app.failure_message(CLI::FailureMessage::simple);
  Common common;
  int exit_code = kDone;
  add_list(app, common, exit_code);
  add_info(app, common, exit_code);
  add_check(app, common, exit_code);
  add_simulate(app, common, exit_code);
  add_run(app, common, exit_code);
  add_evaluate(app, common, exit_code);
  add_study(app, common, exit_code);
  add_improve(app, common, exit_code);
  add_status(app, common, exit_code);
  add_report(app, common, exit_code);
  add_convert(app, common, exit_code);
  add_view(app, common, exit_code);
#ifdef LIDARENA_HAVE_DDS
  add_play(app, common, exit_code);
  add_record(app, common, exit_code);
#endif
  add_schema(app, common, exit_code);
  add_text(app, "completion", "Print a completion script for bash: source <(lidarena completion)",
           bash_completion);
  add_text(app, "man", "Print the manual page: lidarena man | man -l -", man_page);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& e) {
    return app.exit(e) == 0 ? kDone : kBadInput;
  }
  if (app.get_subcommands().empty()) print_overview(app);
  return exit_code;
}

}  // namespace
}  // namespace lidarena

namespace {

/// Says why the program failed, unless standard error cannot be written.
void complain(const char* what) {
  const std::string text = fmt::format("lidarena: {}\n", what);
  std::fwrite(text.data(), 1, text.size(), stderr);
}

}  // namespace

int main(int argc, char** argv) {
  std::signal(SIGXFSZ, SIG_IGN);  // a limit of file sizes is an error of writing, as a full disk is
  try {
    const int exit_code = lidarena::parse_and_do(argc, argv);
    if (std::fflush(stdout) == 0 && std::ferror(stdout) == 0) return exit_code;
    complain("the output cannot be written to standard output; is the disk full?");
    return lidarena::kWorkFailed;
  } catch (const lidarena::InputError& e) {
    complain(e.what());
    return lidarena::kBadInput;
  } catch (const std::exception& e) {
    complain(e.what());
    return lidarena::kWorkFailed;
  }
}
