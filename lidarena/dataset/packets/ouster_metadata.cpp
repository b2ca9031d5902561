// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/dataset/packets/ouster_metadata.hpp"

#include <fmt/format.h>

#include <numbers>

#include "lidarena/base/error.hpp"
#include "lidarena/dataset/json_file.hpp"

namespace lidarena::dataset {
namespace {

/// All keys of all sections in one object: the sections of firmware 3 have the keys of firmware 2.
Json flattened(const Json& json) {
  Json flat = Json::object();
  for (const auto& [key, value] : json.items()) {
    if (value.is_object()) flat.update(flattened(value));
    flat[key] = value;
  }
  return flat;
}

std::vector<double> radians(const Json& degrees) {
  std::vector<double> values;
  for (const Json& value : degrees)
    values.push_back(value.get<double>() * std::numbers::pi / 180.0);
  return values;
}

/// A 4x4 matrix in rows whose translation is in mm.
Pose transform(const Json& json) {
  const auto v = json.get<std::vector<double>>();
  Eigen::Matrix3d rotation;
  for (int i = 0; i < 9; ++i)
    rotation(i / 3, i % 3) = v.at(static_cast<std::size_t>(4 * (i / 3) + i % 3));
  return make_pose(Eigen::Quaterniond(rotation),
                   1e-3 * Eigen::Vector3d(v.at(3), v.at(7), v.at(11)));
}

OusterProfile profile_named(const std::string& name, const std::string& place) {
  if (name == "LEGACY") return OusterProfile::kLegacy;
  if (name == "RNG19_RFL8_SIG16_NIR16") return OusterProfile::kSingle;
  if (name == "RNG19_RFL8_SIG16_NIR16_DUAL") return OusterProfile::kDual;
  if (name == "RNG15_RFL8_NIR8") return OusterProfile::kLowRate;
  throw InputError(place, "its UDP profile is " + name,
                   "read are LEGACY, RNG19_RFL8_SIG16_NIR16, RNG19_RFL8_SIG16_NIR16_DUAL and "
                   "RNG15_RFL8_NIR8; convert the capture with Ouster's tools to a bag");
}

OusterMetadata parsed(const Json& flat, const std::string& place) {
  OusterMetadata meta;
  meta.model = flat.at("prod_line").get<std::string>();
  meta.profile = profile_named(flat.value("udp_profile_lidar", "LEGACY"), place);
  meta.columns_per_frame = flat.at("columns_per_frame").get<int>();
  meta.columns_per_packet = flat.value("columns_per_packet", 16);
  const auto mode = flat.at("lidar_mode").get<std::string>();  // e.g. 1024x10
  meta.rate_hz = std::stod(mode.substr(mode.find('x') + 1));
  meta.altitude_rad = radians(flat.at("beam_altitude_angles"));
  meta.azimuth_rad = radians(flat.at("beam_azimuth_angles"));
  meta.beam_origin_m.x() = 1e-3 * flat.value("lidar_origin_to_beam_origin_mm", 0.0);
  if (flat.contains("beam_to_lidar_transform")) {
    const Pose lidar_from_beam = transform(flat.at("beam_to_lidar_transform"));
    meta.beam_origin_m = {lidar_from_beam.translation().x(), lidar_from_beam.translation().z()};
  }
  meta.sensor_from_lidar = transform(flat.at("lidar_to_sensor_transform"));
  meta.sensor_from_imu = transform(flat.at("imu_to_sensor_transform"));
  meta.lidar_port = flat.value("udp_port_lidar", std::uint16_t{7502});
  meta.imu_port = flat.value("udp_port_imu", std::uint16_t{7503});
  return meta;
}

}  // namespace

bool is_ouster_metadata(const Json& json) {
  return json.is_object() && flattened(json).contains("beam_altitude_angles");
}

OusterMetadata read_ouster_metadata(const std::filesystem::path& file) {
  const std::string place = file.string();
  try {
    OusterMetadata meta = parsed(flattened(read_json(file)), place);
    const bool fits = meta.rows() > 0 && meta.rows() <= 256 &&
                      meta.azimuth_rad.size() == meta.rows() && meta.columns_per_frame > 0 &&
                      meta.columns_per_frame <= 8192 && meta.columns_per_packet > 0 &&
                      meta.columns_per_packet <= 64 && meta.rate_hz > 0.0;
    if (!fits) throw InputError(place, "its beams or columns contradict each other");
    return meta;
  } catch (const Json::exception& error) {
    throw InputError(place, fmt::format("is not the metadata of an Ouster ({})", error.what()),
                     "take it from the sensor: http://SENSOR/api/v1/sensor/metadata");
  } catch (const std::logic_error&) {  // of std::stod, or a matrix that is too short
    throw InputError(place, "its lidar_mode or a transform is broken",
                     "take the file from the sensor again");
  }
}

}  // namespace lidarena::dataset
