// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <algorithm>
#include <fstream>

#include "apps/lidarena/verbs.hpp"
#include "lidarena/odometry/factory.hpp"
#include "lidarena/sensor/sensor_config.hpp"
#include "lidarena/stages/ready_program.hpp"

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

/// Limits of the sensors to list; 0 = none.
struct SensorFilter {
  double fov_min = 0.0;     ///< deg
  double points_min = 0.0;  ///< 1/s
  double range_min = 0.0;   ///< m
  double weight_max = 0.0;  ///< kg
  double power_max = 0.0;   ///< W
};

bool is_empty(const SensorFilter& filter) {
  return filter.fov_min + filter.points_min + filter.range_min + filter.weight_max +
             filter.power_max ==
         0.0;
}

/// The smaller of the two angles of a field of view, deg.
double smaller_angle(const sensor::FieldOfView& fov) {
  return std::min({fov.azimuth_max_deg - fov.azimuth_min_deg,
                   fov.elevation_max_deg - fov.elevation_min_deg, 2.0 * fov.half_angle_deg});
}

enum class Verdict { kListed, kLeftOut, kUnknown };

/// Judges by one figure, 0 = unknown; a limit of 0 admits all.
Verdict judge(double figure, double low, double high) {
  if (low <= 0.0 && high <= 0.0) return Verdict::kListed;
  if (figure <= 0.0) return Verdict::kUnknown;
  const bool is_within = figure >= low && (high <= 0.0 || figure <= high);
  return is_within ? Verdict::kListed : Verdict::kLeftOut;
}

/// A figure beyond its limit outweighs one that is unknown.
Verdict judge(const SensorFilter& filter, const sensor::SensorConfig& sensor, double points) {
  const sensor::SensorFacts& facts = sensor.facts;
  const auto fov = field_of_view(sensor);
  Verdict verdict = Verdict::kListed;
  for (const Verdict one :
       {judge(fov ? smaller_angle(*fov) : 0.0, filter.fov_min, 0.0),
        judge(points, filter.points_min, 0.0), judge(sensor.max_range_m, filter.range_min, 0.0),
        judge(facts.weight_kg, 0.0, filter.weight_max),
        judge(facts.power_max_w, 0.0, filter.power_max)}) {
    if (one == Verdict::kLeftOut) return one;
    if (one == Verdict::kUnknown) verdict = one;
  }
  return verdict;
}

std::string fov_of(const sensor::SensorConfig& sensor) {
  const auto fov = field_of_view(sensor);
  if (!fov) return "-";
  if (fov->half_angle_deg < 180.0) return fmt::format("circle {:g}", 2.0 * fov->half_angle_deg);
  return fmt::format("{:g} x {:g}", fov->azimuth_max_deg - fov->azimuth_min_deg,
                     fov->elevation_max_deg - fov->elevation_min_deg);
}

constexpr const char* kSensorRow = "{:<26} {:>11} {:>9} {:>6} {:>8} {:>12}  {}\n";

void print_sensor(const sensor::SensorConfig& sensor, double points) {
  const sensor::SensorFacts& facts = sensor.facts;
  fmt::print(kSensorRow, sensor.name, fov_of(sensor), fmt::format("{:.0f}", points),
             range_text(0.0, sensor.max_range_m, "m"),
             range_text(0.0, 1000.0 * facts.weight_kg, "g"),
             range_text(facts.power_min_w, facts.power_max_w, "W"),
             facts.price.empty() ? "-" : facts.price);
}

double points_per_second(const sensor::SensorConfig& sensor) {
  const auto pattern = sensor::make_pattern(sensor);
  return static_cast<double>(pattern->beams_per_scan()) / to_seconds(pattern->period());
}

/// Prints one line per sensor within the limits, or the error if its file is invalid. Says which
/// sensors could not be judged.
int list_sensors(const Common& common, const SensorFilter& filter) {
  const stages::ConfigFolder configs = common.config_folder();
  if (!common.json) {
    fmt::print(kSensorRow, "sensor", "FOV, deg", "points/s", "range", "weight", "power", "price");
  }
  Json list = Json::array();
  std::vector<std::string> unknown;
  for (const std::string& name : configs.names("sensors")) {
    const auto file = configs.resolve("sensors", name);
    Json json{{"name", name}, {"summary", first_comment(file)}};
    try {
      const sensor::SensorConfig sensor = configs.load_sensor(name);
      const double points = points_per_second(sensor);
      const Verdict verdict = judge(filter, sensor, points);
      if (verdict == Verdict::kUnknown) unknown.push_back(name);
      if (verdict != Verdict::kListed) continue;
      json.update({{"fov_deg", fov_of(sensor)},
                   {"points_per_second", points},
                   {"max_range_m", sensor.max_range_m},
                   {"facts", to_json(sensor.facts)}});
      if (!common.json) print_sensor(sensor, points);
    } catch (const InputError& error) {
      json["error"] = error.what();
      if (!common.json) fmt::print("{:<26} {}\n", name, error.what());
    }
    list.push_back(json);
  }
  if (common.json) print_json(list);
  if (!unknown.empty() && !common.quiet) {
    fmt::print(stderr, "not listed, since a figure of theirs is unknown: {}\n",
               fmt::join(unknown, ", "));
  }
  return kDone;
}

int list_configs(const Common& common, const std::string& kind) {
  const stages::ConfigFolder configs = common.config_folder();
  Json list = Json::array();
  for (const std::string& name : configs.names(kind)) {
    const std::string summary = first_comment(configs.resolve(kind, name));
    list.push_back({{"name", name}, {"summary", summary}});
    if (!common.json) fmt::print("{:<24} {}\n", name, summary);
  }
  if (common.json) print_json(list);
  return kDone;
}

/// Programs of others, whether they are installed, and how to install those that are not.
int list_programs(const Common& common) {
  const stages::ConfigFolder configs = common.config_folder();
  Json list = Json::array();
  for (const std::string& name : configs.names("programs")) {
    const std::filesystem::path file = configs.resolve("programs", name);
    const stages::ExternalProgram program = stages::load_program(file);
    const std::string summary = first_comment(file);
    const bool installed = stages::is_installed(program);
    list.push_back({{"name", name},
                    {"summary", summary},
                    {"installed", installed},
                    {"install", program.install}});
    if (common.json) continue;
    fmt::print("{:<18} {}\n{:<18} {}\n", name, summary, "",
               installed ? "installed" : "not installed: " + program.install);
  }
  if (common.json) print_json(list);
  return kDone;
}

}  // namespace

void add_list(CLI::App& app, Common& common, int& exit_code) {
  auto* verb = app.add_subcommand(
      "list",
      "List the available worlds, flights, sensors, algorithms, studies, recordings or programs");
  auto kind = std::make_shared<std::string>();
  auto filter = std::make_shared<SensorFilter>();
  verb->add_option("kind", *kind,
                   "worlds, flights, sensors, algorithms, studies, recordings or programs")
      ->required()
      ->check(CLI::IsMember(
          {"worlds", "flights", "sensors", "algorithms", "studies", "recordings", "programs"}));
  const auto add_limit = [verb](const char* name, double& limit, const char* what) {
    return verb->add_option(name, limit, what)->check(CLI::PositiveNumber);
  };
  add_limit("--fov-min", filter->fov_min,
            "Of sensors, those with this field of view, deg: the smaller of its two angles");
  add_limit("--points-min", filter->points_min, "... with this many points per second");
  add_limit("--range-min", filter->range_min, "... with this range, m");
  add_limit("--weight-max", filter->weight_max, "... of at most this weight, kg");
  add_limit("--power-max", filter->power_max, "... that take at most this power, W");
  set_verb(
      *verb, common,
      [&common, kind, filter] {
        if (*kind == "sensors") return list_sensors(common, *filter);
        if (!is_empty(*filter)) {
          throw InputError("list " + *kind, "has no limits to choose by",
                           "--fov-min and the like are for: lidarena list sensors");
        }
        if (*kind == "programs") return list_programs(common);
        return *kind == "algorithms" ? list_algorithms_verb(common) : list_configs(common, *kind);
      },
      exit_code);
}

}  // namespace lidarena
