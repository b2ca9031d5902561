// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/sensor/sensor_config.hpp"

#include "lidarena/base/error.hpp"
#include "lidarena/sensor/livox.hpp"
#include "lidarena/sensor/ouster.hpp"

namespace lidarena {
namespace {

std::unique_ptr<ScanPattern> make_pattern(const SensorConfig& sensor, const std::string& place) {
  if (sensor.model != LidarModel::kOusterOs0128 && sensor.columns != 0) {
    throw InputError(place, "columns is set, but this model does not spin", "remove columns");
  }
  switch (sensor.model) {
    case LidarModel::kLivoxMid360:
      return std::make_unique<LivoxPattern>(livox_mid360(), sensor.rate_hz, place);
    case LidarModel::kLivoxMid40:
      return std::make_unique<LivoxPattern>(livox_mid40(), sensor.rate_hz, place);
    case LidarModel::kLivoxMid70:
      return std::make_unique<LivoxPattern>(livox_mid70(), sensor.rate_hz, place);
    case LidarModel::kOusterOs0128:
      return std::make_unique<OusterOs0Pattern>(sensor.columns, sensor.rate_hz, place);
  }
  throw InputError(place, "the model is not known");
}

}  // namespace

std::unique_ptr<ScanPattern> make_pattern(const SensorConfig& sensor) {
  return make_pattern(sensor, sensor.name.empty() ? "sensor" : sensor.name);
}

SensorConfig load_sensor(const std::filesystem::path& file) {
  auto sensor = load_config<SensorConfig>(file);
  if (sensor.name.empty()) sensor.name = file.stem().string();
  if (sensor.min_range_m >= sensor.max_range_m) {
    throw InputError(file.string(), "min_range_m is not below max_range_m");
  }
  check_returns(sensor.noise, sensor.returns, file.string());
  make_pattern(sensor, file.string());  // the model must have this mode
  return sensor;
}

}  // namespace lidarena
