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

/// Whether the run was made of live topics.
bool is_live(const results::RunRecord& row) { return row.manifest && row.manifest->live; }

std::string simulate_command(const results::RunRecord& row) {
  const dataset::SimulationRecord& made = *row.simulation;
  std::string command = "lidarena simulate" + option("--world", row.sources.world) +
                        option("--flight", row.sources.flight);
  for (const std::string& sensor : row.sources.sensors) command += option("--sensor", sensor);
  for (const std::string& set : made.set) command += option("--set", set);
  command += option("--seed", std::to_string(made.seed));
  if (made.new_scene) command += " --new-scene";
  if (made.seconds > 0.0) command += option("--seconds", Json(made.seconds).dump());
  command += option("--mode", row.mode.empty() ? made.mode : row.mode);
  if (!made.noise) command += " --noise off";
  if (made.allow_missing) command += " --allow-missing";
  return command + (is_live(row) ? " --out data" : " --no-data --hits on --out data");
}

/// What was set beside the preset.
std::string settings_of(const results::RunRecord& row) {
  if (!row.manifest) return option("--preset", row.preset);
  const dataset::RunManifest& manifest = *row.manifest;
  if (row.preset == "external") {
    const fs::path in_study = row.folder / "external.json";
    return option("--external",
                  fs::exists(in_study) ? in_study.generic_string() : row.algorithm + ".yaml");
  }
  std::string settings = option("--preset", row.preset) + option("--config", manifest.config_file);
  for (const std::string& set : manifest.overrides) settings += option("--set", set);
  if (manifest.parts > 1) settings += option("--parts", std::to_string(manifest.parts));
  if (manifest.paced) settings += " --paced";
  return settings;
}

/// What listens to live topics, beside a player; a foreign node is to be started, too.
std::string live_command(const results::RunRecord& row, const std::string& dataset) {
  const bool is_recorded = row.preset == "live";
  const std::string listener =
      is_recorded
          ? fmt::format("lidarena record --truth {}{}", dataset, option("--name", row.algorithm))
          : fmt::format("lidarena run {} {} --live{}", shell_word(row.algorithm), dataset,
                        settings_of(row));
  return fmt::format("{{ {}{} --out run & lidarena play {} && wait; }} && lidarena evaluate run",
                     listener, option("--sensor", row.sensor), dataset);
}

}  // namespace

std::string command_of(const results::RunRecord& row) {
  if (row.known) return {};  // its flight is not here
  const bool is_simulated = row.simulation.has_value();
  std::string dataset = "data";
  if (!is_simulated && row.manifest) {
    dataset = (row.folder / row.manifest->dataset).lexically_normal().generic_string();
  }
  const std::string simulate = is_simulated ? simulate_command(row) + " && " : "";
  if (is_live(row)) return simulate + live_command(row, shell_word(dataset));
  return fmt::format("{}lidarena run {} {}{}{} --out run && lidarena evaluate run", simulate,
                     shell_word(row.algorithm), shell_word(dataset), settings_of(row),
                     option("--sensor", row.sensor));
}

}  // namespace lidarena::report
