// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <fstream>

#include "apps/lidarena/verbs.hpp"
#include "lidarena/odometry/factory.hpp"
#include "lidarena/sensor/sensor_config.hpp"

namespace lidarena {
namespace {

/// The first comment line of a configuration file, which describes it; empty if there is none.
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
  for (const odometry::AlgorithmInfo& info : odometry::list_algorithms()) {
    list.push_back({{"name", info.name},
                    {"summary", info.summary},
                    {"presets", info.presets},
                    {"needs_imu", info.needs_imu}});
    if (common.json) continue;
    fmt::print("{:<14} {}", info.name, info.summary);
    if (!info.presets.empty()) fmt::print(" (presets: {})", fmt::join(info.presets, ", "));
    fmt::print("\n");
  }
  if (common.json) print_json(list);
  return kDone;
}

/// "a" or "a to b" with a unit; "-" if unknown.
std::string range_text(double low, double high, const char* unit) {
  if (high <= 0.0) return "-";
  return low > 0.0 && low < high ? fmt::format("{:g} to {:g} {}", low, high, unit)
                                 : fmt::format("{:g} {}", high, unit);
}

std::string fov_of(const sensor::SensorFacts& facts) {
  if (!facts.fov) return "-";
  const sensor::FieldOfView& fov = *facts.fov;
  if (fov.half_angle_deg < 180.0) return fmt::format("circle {:g}", 2.0 * fov.half_angle_deg);
  return fmt::format("{:g} x {:g}", fov.azimuth_max_deg - fov.azimuth_min_deg,
                     fov.elevation_max_deg - fov.elevation_min_deg);
}

/// Prints one line per sensor with its main specifications, or the error if its file is invalid.
int list_sensors(const Common& common) {
  const study::ConfigFolder configs = common.config_folder();
  constexpr const char* kRow = "{:<26} {:>11} {:>9} {:>6} {:>8} {:>12}  {}\n";
  if (!common.json) {
    fmt::print(kRow, "sensor", "FOV, deg", "points/s", "range", "weight", "power", "price");
  }
  Json list = Json::array();
  for (const std::string& name : configs.names("sensors")) {
    const auto file = configs.resolve("sensors", name);
    Json json{{"name", name}, {"summary", first_comment(file)}};
    try {
      const sensor::SensorConfig sensor = sensor::load_sensor(file);
      const auto pattern = sensor::make_pattern(sensor);
      const double rate =
          static_cast<double>(pattern->beams_per_scan()) / to_seconds(pattern->period());
      const sensor::SensorFacts& facts = sensor.facts;
      json.update({{"fov_deg", fov_of(facts)},
                   {"points_per_second", rate},
                   {"max_range_m", sensor.max_range_m},
                   {"facts", to_json(facts)}});
      if (!common.json) {
        fmt::print(kRow, name, fov_of(facts), fmt::format("{:.0f}", rate),
                   range_text(0.0, sensor.max_range_m, "m"),
                   range_text(0.0, 1000.0 * facts.weight_kg, "g"),
                   range_text(facts.power_min_w, facts.power_max_w, "W"),
                   facts.price.empty() ? "-" : facts.price);
      }
    } catch (const InputError& error) {
      json["error"] = error.what();
      if (!common.json) fmt::print("{:<26} {}\n", name, error.what());
    }
    list.push_back(json);
  }
  if (common.json) print_json(list);
  return kDone;
}

int list_configs(const Common& common, const std::string& kind) {
  const study::ConfigFolder configs = common.config_folder();
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
  auto* verb = app.add_subcommand(
      "list", "List the available worlds, flights, sensors, algorithms or studies");
  auto kind = std::make_shared<std::string>();
  verb->add_option("kind", *kind, "worlds, flights, sensors, algorithms or studies")
      ->required()
      ->check(CLI::IsMember({"worlds", "flights", "sensors", "algorithms", "studies"}));
  set_verb(
      *verb, common,
      [&common, kind] {
        if (*kind == "algorithms") return list_algorithms_verb(common);
        if (*kind == "sensors") return list_sensors(common);
        return list_configs(common, *kind);
      },
      exit_code);
}

}  // namespace lidarena
