// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <vector>

#include "lidarena/base/config_json.hpp"
#include "lidarena/base/pose.hpp"

namespace lidarena::dataset {

/// How the returns of an Ouster are packed into its LiDAR packets ("UDP profile").
enum class OusterProfile {
  kLegacy,   ///< LEGACY
  kSingle,   ///< RNG19_RFL8_SIG16_NIR16
  kDual,     ///< RNG19_RFL8_SIG16_NIR16_DUAL
  kLowRate,  ///< RNG15_RFL8_NIR8
};

/// What the metadata of an Ouster (JSON, from its web page or HTTP interface) say about its packets
/// and beams; flat, as of firmware 2, or in sections, as of firmware 3.
struct OusterMetadata {
  std::string model;  ///< e.g. OS-1-128
  OusterProfile profile = OusterProfile::kLegacy;
  int columns_per_frame = 1024;
  int columns_per_packet = 16;
  double rate_hz = 10.0;
  std::vector<double> altitude_rad;  ///< of each row
  std::vector<double> azimuth_rad;   ///< of each row, against the encoder's angle
  Eigen::Vector2d beam_origin_m = Eigen::Vector2d::Zero();  ///< from the axis: outwards, up
  Pose sensor_from_lidar = Pose::Identity();
  Pose sensor_from_imu = Pose::Identity();
  std::uint16_t lidar_port = 7502;
  std::uint16_t imu_port = 7503;

  std::size_t rows() const { return altitude_rad.size(); }
};

/// Throws InputError (place: the file) when a key is missing or a value is of another kind.
OusterMetadata read_ouster_metadata(const std::filesystem::path& file);
/// Whether a JSON document has the keys of such metadata.
bool is_ouster_metadata(const Json& json);

}  // namespace lidarena::dataset
