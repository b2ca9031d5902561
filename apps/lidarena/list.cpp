// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <fstream>

#include "apps/lidarena/verbs.hpp"
#include "lidarena/odometry/factory.hpp"

namespace lidarena {
namespace {

/// The first comment line of a configuration file says what it is.
std::string first_comment(const std::filesystem::path& file) {
  std::ifstream in(file);
  std::string line;
  while (std::getline(in, line)) {
    if (line.rfind("# ", 0) == 0 && line.find("SPDX") == std::string::npos) return line.substr(2);
    if (!line.empty() && line[0] != '#') break;
  }
  return "";
}

int list_algorithms_verb(const Common& common) {
  Json list = Json::array();
  for (const AlgorithmInfo& info : list_algorithms()) {
    list.push_back({{"name", info.name},
                    {"summary", info.summary},
                    {"presets", info.presets},
                    {"needs_imu", info.needs_imu}});
    if (common.json) continue;
    fmt::print("{:<14} {} (presets: {})\n", info.name, info.summary, fmt::join(info.presets, ", "));
  }
  if (common.json) print_json(list);
  return kDone;
}

int list_configs(const Common& common, const std::string& kind) {
  const ConfigFolder configs = common.config_folder();
  Json list = Json::array();
  for (const std::string& name : configs.names(kind)) {
    const std::string summary = first_comment(configs.resolve(kind, name));
    list.push_back({{"name", name}, {"summary", summary}});
    if (!common.json) fmt::print("{:<24} {}\n", name, summary);
  }
  if (common.json) print_json(list);
  return kDone;
}

}  // namespace

void add_list(CLI::App& app, Common& common, int& exit_code) {
  auto* verb = app.add_subcommand("list", "What there is: a line each");
  auto kind = std::make_shared<std::string>();
  verb->add_option("kind", *kind, "worlds, flights, sensors, algorithms or studies")
      ->required()
      ->check(CLI::IsMember({"worlds", "flights", "sensors", "algorithms", "studies"}));
  set_verb(
      *verb, common,
      [&common, kind] {
        return *kind == "algorithms" ? list_algorithms_verb(common) : list_configs(common, *kind);
      },
      exit_code);
}

}  // namespace lidarena
