// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>

#include "lidarena/base/error.hpp"
#include "lidarena/sensor/livox.hpp"
#include "lidarena/sensor/livox_csv.hpp"
#include "lidarena/sensor/ouster.hpp"
#include "lidarena/sensor/sensor_config.hpp"
#include "lidarena/sensor/shaped_pattern.hpp"

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
  reject("shape.shots_per_second", sensor.shape.shots_per_second != 0.0, !csv);
}

/// How `shape` maps elevations. Throws InputError if it cannot.
ElevationMap elevation_map(const SensorConfig& sensor, const std::string& place) {
  ElevationMap map{1.0, sensor.shape.fov_shift_deg};
  const double height = sensor.shape.fov_height_deg;
  if (height == 0.0 && map.shift == 0.0) return map;
  const auto& fov = sensor.facts.fov;
  if (!fov) {
    throw InputError(place, "shape changes the field of view, which the sensor does not state",
                     "set facts.fov: {elevation_min_deg: ..., elevation_max_deg: ...}");
  }
  if (height > 0.0) {
    const double middle = 0.5 * (fov->elevation_min_deg + fov->elevation_max_deg);
    map.scale = height / (fov->elevation_max_deg - fov->elevation_min_deg);
    map.shift += middle - map.scale * middle;
  }
  const double low = map(fov->elevation_min_deg), high = map(fov->elevation_max_deg);
  if (low < -90.0 - 1e-9 || high > 90.0 + 1e-9) {
    throw InputError(place,
                     "shape puts the field of view from " + std::to_string(low) + " to " +
                         std::to_string(high) + " deg, beyond 90 deg",
                     "lower shape.fov_height_deg, or bring shape.fov_shift_deg closer to 0");
  }
  return map;
}

/// How many times as often as those of the product the lasers fire, which has `shots` per second.
/// Throws InputError if a scan would not be made of whole columns, or groups, of `lasers` shots.
double shots_factor(const SensorConfig& sensor, double shots, std::size_t lasers,
                    const std::string& place) {
  const double wanted = sensor.shape.shots_per_second;
  if (wanted == 0.0 || !(shots > 0.0)) return 1.0;
  const double step = sensor.rate_hz * static_cast<double>(lasers);
  const double columns = wanted / step;
  if (columns < 0.5 || std::abs(columns - std::round(columns)) > 1e-9 * columns) {
    throw InputError(place,
                     "shape.shots_per_second would give " + std::to_string(columns) +
                         " firings of all lasers per scan",
                     "use a multiple of " + std::to_string(std::llround(step)));
  }
  return wanted / shots;
}

/// A spinning head of `lasers`: how many times as often it fires, and in how many columns.
struct Firing {
  double factor = 1.0;
  int columns = 0;
};
Firing firing_of(const SensorConfig& sensor, std::size_t lasers, const std::string& place) {
  const double shots = sensor.columns * sensor.rate_hz * static_cast<double>(lasers);
  const double factor = shots_factor(sensor, shots, lasers, place);
  return {factor, static_cast<int>(std::lround(factor * sensor.columns))};
}

/// The head whose lasers fire `factor` times as often.
SpinningHead faster(SpinningHead head, double factor) {
  if (factor == 1.0) return head;
  head.column_period_us /= factor;
  for (HeadBeam& beam : head.beams) beam.dt_us /= factor;
  return head;
}

/// The Livox with as many shots as `shape` says. Throws InputError if it cannot have them.
LivoxModel with_shots(LivoxModel model, const SensorConfig& sensor, const std::string& place) {
  const double factor = shots_factor(sensor, model.row_rate_hz, model.emitters.size(), place);
  if (factor == 1.0) return model;
  const double groups = factor * static_cast<double>(model.repeat_groups);
  if (std::abs(groups - std::round(groups)) > 1e-9 * groups) {
    throw InputError(place, "the pattern would not repeat with this shape.shots_per_second",
                     "use a rounder number");
  }
  model.row_rate_hz = sensor.shape.shots_per_second;
  model.shots_factor = factor;
  model.repeat_groups = static_cast<std::uint64_t>(std::llround(groups));
  return model;
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

/// The pattern of the model, with as many shots as `shape` says.
std::unique_ptr<ScanPattern> model_pattern(const SensorConfig& sensor, const std::string& place) {
  const auto livox = [&](const LivoxModel& model) {
    return std::make_unique<LivoxPattern>(with_shots(model, sensor, place), sensor.rate_hz, place);
  };
  switch (sensor.model) {
    case LidarModel::kLivoxMid360:
      return livox(livox_mid360());
    case LidarModel::kLivoxMid40:
      return livox(livox_mid40());
    case LidarModel::kLivoxMid70:
      return livox(livox_mid70());
    case LidarModel::kLivoxAvia:
      return livox(livox_avia());
    case LidarModel::kOusterOs0128:
      return std::make_unique<OusterOs0Pattern>(
          sensor.columns, sensor.rate_hz, place,
          firing_of(sensor, OusterOs0Pattern::kRows, place).columns);
    case LidarModel::kLivoxCsv:
      return make_csv_pattern(sensor, place);
    case LidarModel::kBeamTable:
      if (!sensor.beam_table) {
        throw InputError(place, "the beam table is missing",
                         "set pattern_file to a YAML file of beams");
      }
      {
        const Firing firing = firing_of(sensor, sensor.beam_table->beams.size(), place);
        return std::make_unique<SpinningHeadPattern>(faster(*sensor.beam_table, firing.factor),
                                                     firing.columns, sensor.rate_hz, place);
      }
  }
  throw InputError(place, "unknown model");
}

}  // namespace

std::unique_ptr<ScanPattern> make_pattern(const SensorConfig& sensor, const std::string& place) {
  reject_foreign_keys(sensor, place);
  auto pattern = model_pattern(sensor, place);
  const ElevationMap map = elevation_map(sensor, place);
  if (map.is_identity() && !sensor.shape.repetitive) return pattern;
  return std::make_unique<ShapedPattern>(std::move(pattern), map, sensor.shape.repetitive);
}

std::optional<FieldOfView> field_of_view(const SensorConfig& sensor) {
  if (!sensor.facts.fov) return std::nullopt;
  FieldOfView fov = *sensor.facts.fov;
  const ElevationMap map = elevation_map(sensor, sensor.name);
  fov.elevation_min_deg = map(fov.elevation_min_deg);
  fov.elevation_max_deg = map(fov.elevation_max_deg);
  if (const auto& clip = sensor.shape.clip) {
    fov.azimuth_min_deg = std::max(fov.azimuth_min_deg, clip->azimuth_min_deg);
    fov.azimuth_max_deg = std::min(fov.azimuth_max_deg, clip->azimuth_max_deg);
    fov.elevation_min_deg = std::max(fov.elevation_min_deg, clip->elevation_min_deg);
    fov.elevation_max_deg = std::min(fov.elevation_max_deg, clip->elevation_max_deg);
    fov.half_angle_deg = std::min(fov.half_angle_deg, clip->half_angle_deg);
  }
  return fov;
}

std::unique_ptr<ScanPattern> make_pattern(const SensorConfig& sensor) {
  return make_pattern(sensor, sensor.name.empty() ? "sensor" : sensor.name);
}

}  // namespace lidarena::sensor
