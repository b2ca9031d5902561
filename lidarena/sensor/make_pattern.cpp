// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/base/error.hpp"
#include "lidarena/sensor/livox.hpp"
#include "lidarena/sensor/livox_csv.hpp"
#include "lidarena/sensor/ouster.hpp"
#include "lidarena/sensor/sensor_config.hpp"

namespace lidarena::sensor {
namespace {

/// Throws InputError if a key is set that the model of this sensor does not use.
void reject_foreign_keys(const SensorConfig& sensor, const std::string& place) {
  const bool csv = sensor.model == LidarModel::kLivoxCsv;
  const bool table = sensor.model == LidarModel::kBeamTable;
  const bool spins = table || sensor.model == LidarModel::kOusterOs0128;
  const auto reject = [&](const std::string& key, bool is_set, bool allowed) {
    if (is_set && !allowed) {
      throw InputError(place, key + " is set, but this model does not use it", "remove " + key);
    }
  };
  reject("columns", sensor.columns != 0, spins);
  reject("pattern_file", !sensor.pattern_file.empty(), csv || table);
  reject("row_rate_hz", sensor.row_rate_hz != 0.0, csv);
  reject("lines", sensor.lines != 1, csv);
  reject("beam_table", sensor.beam_table.has_value(), table);
}

std::unique_ptr<ScanPattern> make_csv_pattern(const SensorConfig& sensor,
                                              const std::string& place) {
  if (sensor.pattern_file.empty()) {
    throw InputError(place, "the table of rays is missing",
                     "set pattern_file to a CSV file in Livox's format");
  }
  if (sensor.row_rate_hz <= 0.0) {
    throw InputError(place, "the firing rate of the table's rows is missing", "set row_rate_hz");
  }
  return std::make_unique<RayTablePattern>(read_livox_csv(sensor.pattern_file), sensor.row_rate_hz,
                                           sensor.lines, sensor.rate_hz, place);
}

}  // namespace

std::unique_ptr<ScanPattern> make_pattern(const SensorConfig& sensor, const std::string& place) {
  reject_foreign_keys(sensor, place);
  switch (sensor.model) {
    case LidarModel::kLivoxMid360:
      return std::make_unique<LivoxPattern>(livox_mid360(), sensor.rate_hz, place);
    case LidarModel::kLivoxMid40:
      return std::make_unique<LivoxPattern>(livox_mid40(), sensor.rate_hz, place);
    case LidarModel::kLivoxMid70:
      return std::make_unique<LivoxPattern>(livox_mid70(), sensor.rate_hz, place);
    case LidarModel::kLivoxAvia:
      return std::make_unique<LivoxPattern>(livox_avia(), sensor.rate_hz, place);
    case LidarModel::kOusterOs0128:
      return std::make_unique<OusterOs0Pattern>(sensor.columns, sensor.rate_hz, place);
    case LidarModel::kLivoxCsv:
      return make_csv_pattern(sensor, place);
    case LidarModel::kBeamTable:
      if (!sensor.beam_table) {
        throw InputError(place, "the beam table is missing",
                         "set pattern_file to a YAML file of beams");
      }
      return std::make_unique<SpinningHeadPattern>(*sensor.beam_table, sensor.columns,
                                                   sensor.rate_hz, place);
  }
  throw InputError(place, "unknown model");
}

std::unique_ptr<ScanPattern> make_pattern(const SensorConfig& sensor) {
  return make_pattern(sensor, sensor.name.empty() ? "sensor" : sensor.name);
}

}  // namespace lidarena::sensor
