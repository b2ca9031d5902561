// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/report/run_command.hpp"

#include <fmt/format.h>

#include "lidarena/base/shell_word.hpp"

namespace lidarena::report {
namespace {

namespace fs = std::filesystem;

std::string option(const char* name, const std::string& value) {
  return value.empty() ? "" : fmt::format(" {} {}", name, shell_word(value));
}

std::string text_in(const Json& json, const char* key) {
  return json.contains(key) && json.at(key).is_string() ? json.at(key).get<std::string>() : "";
}

std::string simulate_command(const results::RunRecord& row) {
  const Json& made = row.simulation;
  std::string command = "lidarena simulate" + option("--world", row.sources.world) +
                        option("--flight", row.sources.flight);
  for (const std::string& sensor : row.sources.sensors) command += option("--sensor", sensor);
  if (made.contains("seed")) command += option("--seed", made.at("seed").dump());
  if (made.value("new_scene", false)) command += " --new-scene";
  if (made.contains("seconds")) command += option("--seconds", made.at("seconds").dump());
  command += option("--mode", row.mode.empty() ? text_in(made, "mode") : row.mode);
  if (!made.value("noise", true)) command += " --noise off";
  if (made.value("allow_missing", false)) command += " --allow-missing";
  return command + " --no-data --out data";
}

/// What was set beside the preset.
std::string settings_of(const results::RunRecord& row) {
  const Json& manifest = row.manifest;
  if (!manifest.is_object()) return option("--preset", row.preset);
  const Json::json_pointer program("/config/command");
  if (row.preset == "external" && manifest.contains(program)) {
    const fs::path in_study = row.folder / "external.json";
    return option("--external",
                  fs::exists(in_study) ? in_study.generic_string() : row.algorithm + ".yaml");
  }
  std::string settings =
      option("--preset", row.preset) + option("--config", text_in(manifest, "config_file"));
  for (const Json& set : manifest.value("overrides", Json::array()))
    settings += option("--set", set.get<std::string>());
  if (manifest.value("paced", false)) settings += " --paced";
  return settings;
}

}  // namespace

std::string command_of(const results::RunRecord& row) {
  const bool is_simulated = row.simulation.is_object();
  std::string dataset = "data";
  if (!is_simulated && row.manifest.is_object()) {
    dataset = (row.folder / row.manifest.value("dataset", "")).lexically_normal().generic_string();
  }
  return fmt::format("{}lidarena run {} {}{}{} --out run && lidarena evaluate run",
                     is_simulated ? simulate_command(row) + " && " : "", shell_word(row.algorithm),
                     shell_word(dataset), settings_of(row), option("--sensor", row.sensor));
}

}  // namespace lidarena::report
