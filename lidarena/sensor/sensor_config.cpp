// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/sensor/sensor_config.hpp"

#include <algorithm>
#include <string>

#include "lidarena/base/error.hpp"

namespace lidarena::sensor {
namespace {

namespace fs = std::filesystem;

void check_fov(const std::optional<FieldOfView>& fov, const std::string& key,
               const std::string& place) {
  if (!fov) return;
  if (fov->azimuth_min_deg < fov->azimuth_max_deg &&
      fov->elevation_min_deg < fov->elevation_max_deg)
    return;
  throw InputError(place, key + " is empty", "keep each minimum below its maximum");
}

void check_imu(const std::optional<ImuConfig>& imu, const std::string& place) {
  if (!imu) return;
  if (imu->broadband.low_hz >= imu->broadband.high_hz)
    throw InputError(place, "imu.broadband.low_hz is not below high_hz");
  const bool bent = imu->gyro_nonlinearity > 0.0 && imu->gyro_range == 0.0;
  const bool bent_too = imu->accel_nonlinearity > 0.0 && imu->accel_range == 0.0;
  if (bent || bent_too) {
    throw InputError(place, "an IMU's non-linearity is a share of its range, which is not given",
                     "set imu.gyro_range and imu.accel_range");
  }
}

/// Loads the beam table, or makes the path of the ray table absolute, so that the configuration
/// does not depend on where its file is.
void resolve_pattern_file(const fs::path& file, SensorConfig& sensor) {
  if (sensor.pattern_file.empty()) return;
  const fs::path table = file.parent_path() / sensor.pattern_file;
  if (sensor.model == LidarModel::kLivoxCsv) {
    sensor.pattern_file = fs::absolute(table).lexically_normal().string();
  } else if (sensor.model == LidarModel::kBeamTable && !sensor.beam_table) {
    sensor.beam_table = load_spinning_head(table);
    sensor.pattern_file.clear();
  }
}

/// Reads a file over its base, which is in `sensor`.
void read_over(const fs::path& file, SensorConfig& sensor) {
  SensorFile read{{}, sensor};
  read.sensor.name.clear();
  read.sensor.pattern_file.clear();
  read.sensor.beam_table.reset();
  read_config(ConfigNode::load(file), read);
  resolve_pattern_file(file, read.sensor);
  const bool has_pattern = !read.sensor.pattern_file.empty() || read.sensor.beam_table;
  if (!has_pattern && read.sensor.model == sensor.model) {
    read.sensor.pattern_file = sensor.pattern_file;
    read.sensor.beam_table = sensor.beam_table;
  }
  sensor = std::move(read.sensor);
}

void apply(const std::string& assignment, const fs::path& file, SensorConfig& sensor) {
  if (assignment.starts_with("imu.") && !sensor.imu)
    throw InputError("--set " + assignment, "the sensor " + file.string() + " has no IMU",
                     "leave it out, or give all of the IMU: --set 'imu={rate_hz: 200}'");
  set_field(sensor, assignment);
  if (assignment.starts_with("pattern_file=")) resolve_pattern_file(file, sensor);
}

/// The file that `base`, a value in `file`, names.
fs::path base_file(const ConfigNode& base, const fs::path& file, const fs::path& shipped) {
  const std::string name = base.text();
  const fs::path folder = file.parent_path();
  for (const fs::path& candidate :
       {folder / name, folder / (name + ".yaml"), shipped / (name + ".yaml")}) {
    if (fs::is_regular_file(candidate)) return candidate;
  }
  std::vector<std::string> known;
  std::error_code none;
  for (const auto& entry : fs::directory_iterator(shipped.empty() ? folder : shipped, none)) {
    if (entry.path().extension() == ".yaml") known.push_back(entry.path().stem().string());
  }
  const std::string nearest = nearest_word(name, known);
  throw InputError(base.where(),
                   "'" + name + "' is neither a file beside this one nor the name of a sensor",
                   nearest.empty() ? "lidarena list sensors prints the names"
                                   : "did you mean '" + nearest + "'?");
}

}  // namespace

SpinningHead load_spinning_head(const fs::path& file) {
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

std::vector<fs::path> sensor_files(const fs::path& file, const fs::path& shipped) {
  std::vector<fs::path> files{file};
  while (true) {
    const ConfigNode node = ConfigNode::load(files.back());
    const auto base = node.is_map() ? node.find("base") : std::nullopt;
    if (!base) return files;
    const fs::path next = base_file(*base, files.back(), shipped);
    for (const fs::path& before : files) {
      if (fs::equivalent(before, next))
        throw InputError(base->where(), "leads back to " + before.string(),
                         "remove one base, so that the last file stands on its own");
    }
    files.push_back(next);
  }
}

SensorConfig load_sensor(const fs::path& file, const fs::path& shipped,
                         const std::vector<std::string>& set) {
  const std::vector<fs::path> files = sensor_files(file, shipped);
  SensorConfig sensor;
  for (auto next = files.rbegin(); next != files.rend(); ++next) read_over(*next, sensor);
  for (const std::string& assignment : set) apply(assignment, file, sensor);
  if (sensor.name.empty()) sensor.name = file.stem().string();
  if (sensor.min_range_m >= sensor.max_range_m) {
    throw InputError(file.string(), "min_range_m is not below max_range_m");
  }
  check_returns(sensor.noise, sensor.returns, file.string());
  check_fov(sensor.facts.fov, "facts.fov", file.string());
  check_fov(sensor.shape.clip, "shape.clip", file.string());
  check_imu(sensor.imu, file.string());
  make_pattern(sensor, file.string());  // throws if the model does not have this mode
  return sensor;
}

}  // namespace lidarena::sensor
