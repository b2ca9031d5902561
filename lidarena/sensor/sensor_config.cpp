// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/sensor/sensor_config.hpp"

#include "lidarena/base/error.hpp"

namespace lidarena::sensor {
namespace {

void check_fov(const std::optional<FieldOfView>& fov, const std::string& place) {
  if (!fov) return;
  if (fov->azimuth_min_deg < fov->azimuth_max_deg &&
      fov->elevation_min_deg < fov->elevation_max_deg)
    return;
  throw InputError(place, "facts.fov is empty", "keep each minimum below its maximum");
}

/// Loads the beam table, or makes the path of the ray table absolute, so that the configuration
/// does not depend on where its file is.
void resolve_pattern_file(const std::filesystem::path& file, SensorConfig& sensor) {
  if (sensor.pattern_file.empty()) return;
  const std::filesystem::path table = file.parent_path() / sensor.pattern_file;
  if (sensor.model == LidarModel::kLivoxCsv) {
    sensor.pattern_file = std::filesystem::absolute(table).lexically_normal().string();
  } else if (sensor.model == LidarModel::kBeamTable && !sensor.beam_table) {
    sensor.beam_table = load_spinning_head(table);
    sensor.pattern_file.clear();
  }
}

}  // namespace

SpinningHead load_spinning_head(const std::filesystem::path& file) {
  const ConfigNode node = ConfigNode::load(file);
  SpinningHead table;
  read_config(node, table);
  if (table.beams.empty()) {
    throw InputError(file.string(), "has no beams", "list them under beams:, one per ring");
  }
  for (const ConfigNode& beam : node.find("beams")->items()) {
    if (!beam.find("elevation_deg")) throw InputError(beam.where(), "has no elevation_deg");
  }
  return table;
}

SensorConfig load_sensor(const std::filesystem::path& file) {
  auto sensor = load_config<SensorConfig>(file);
  resolve_pattern_file(file, sensor);
  if (sensor.name.empty()) sensor.name = file.stem().string();
  if (sensor.min_range_m >= sensor.max_range_m) {
    throw InputError(file.string(), "min_range_m is not below max_range_m");
  }
  check_returns(sensor.noise, sensor.returns, file.string());
  check_fov(sensor.facts.fov, file.string());
  make_pattern(sensor, file.string());  // throws if the model does not have this mode
  return sensor;
}

}  // namespace lidarena::sensor
