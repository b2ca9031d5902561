// SPDX-License-Identifier: BSD-3-Clause
#include "adapters/gazebo/plugin/plugin_config.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cstdlib>
#include <filesystem>
#include <sstream>

#include "lidarena/base/error.hpp"

namespace lidarena::gazebo_plugin {
namespace {

namespace fs = std::filesystem;

/// Folder of sensor files: $LIDARENA_SENSORS, or that of the build.
fs::path sensor_folder() {
  const char* folder = std::getenv("LIDARENA_SENSORS");
  return folder != nullptr ? folder : LIDARENA_SENSOR_FOLDER;
}

sensor::SensorConfig named_sensor(const std::string& name, const std::string& place) {
  if (fs::is_regular_file(name)) return sensor::load_sensor(name, sensor_folder());
  const fs::path file = sensor_folder() / (name + ".yaml");
  if (fs::is_regular_file(file)) return sensor::load_sensor(file);
  throw InputError(place, "no sensor '" + name + "' in " + sensor_folder().string(),
                   "give a name from that folder or the path of a file, or set LIDARENA_SENSORS");
}

/// Name of the sensor whose Livox table has this file name; empty if unknown.
std::string sensor_of_table(const std::string& file) {
  std::string name = fs::path(file).filename().string();
  std::transform(name.begin(), name.end(), name.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  constexpr std::array kNames{std::pair{"mid360", "livox_mid360"},
                              std::pair{"mid40", "livox_mid40"}, std::pair{"mid70", "livox_mid70"},
                              std::pair{"avia", "livox_avia"}};
  for (const auto& [part, sensor] : kNames) {
    if (name.find(part) != std::string::npos) return sensor;
  }
  return {};
}

sensor::SensorConfig table_sensor(const PluginConfig& config, const SensorElement& element,
                                  const std::string& place) {
  const std::string known = sensor_of_table(config.csv_file_name);
  if (!fs::is_regular_file(config.csv_file_name)) {
    if (!known.empty()) return named_sensor(known, place);
    throw InputError(place, "no file " + config.csv_file_name,
                     "give the table's full path, or the name of a sensor in <sensor>");
  }
  sensor::SensorConfig sensor;
  sensor.name = fs::path(config.csv_file_name).stem().string();
  sensor.model = sensor::LidarModel::kLivoxCsv;
  sensor.pattern_file = config.csv_file_name;
  sensor.lines = 4;
  sensor.rate_hz = element.update_rate > 0.0 ? element.update_rate : sensor.rate_hz;
  sensor.row_rate_hz = sensor.rate_hz * (config.samples > 0 ? config.samples : 20'000);
  return sensor;
}

}  // namespace

sensor::SensorConfig sensor_of(const PluginConfig& config, const SensorElement& element,
                               const std::string& place) {
  sensor::SensorConfig sensor = config.csv_file_name.empty() ? named_sensor(config.sensor, place)
                                                             : table_sensor(config, element, place);
  if (!config.csv_file_name.empty()) {  // only here the SDF file describes the sensor
    if (element.min_range > 0.0) sensor.min_range_m = element.min_range;
    if (element.max_range > 0.0) sensor.max_range_m = element.max_range;
  }
  std::istringstream assignments(config.set);
  for (std::string assignment; assignments >> assignment;) set_field(sensor, assignment);
  if (!config.id.empty()) sensor.name = config.id;
  if (!config.imu) sensor.imu.reset();
  sensor.body_from_lidar = element.body_from_sensor;
  sensor::make_pattern(sensor, place);  // throws if the model does not have this mode
  return sensor;
}

}  // namespace lidarena::gazebo_plugin
