// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "lidarena/base/config_json.hpp"
#include "lidarena/base/parallel.hpp"
#include "lidarena/base/rig.hpp"
#include "lidarena/odometry/odometry.hpp"

namespace lidarena {

/// What to build.
struct OdometryRequest {
  std::string algorithm;                 ///< a name of list_algorithms()
  std::string preset = "improved";       ///< "original", "improved", or one more the algorithm has
  std::string config_file{};             ///< YAML over the preset; may be empty
  std::vector<std::string> overrides{};  ///< "key=value", over everything
};

struct AlgorithmInfo {
  std::string name;
  std::string summary;
  std::vector<std::string> presets;
  bool needs_imu = false;
};

/// The explicit table of algorithms.
std::vector<AlgorithmInfo> list_algorithms();

/// JSON Schema of the configuration file of the algorithm `name`. Throws InputError when there is
/// none.
Json algorithm_schema(const std::string& name);

struct MadeOdometry {
  std::unique_ptr<Odometry> odometry;
  Json config;  ///< the configuration in full, for the manifest
};

/// Builds an odometry for the LiDAR `lidar_id` of `rig` (empty: its only one).
/// Throws InputError for an unknown algorithm or preset (naming the nearest), a bad configuration,
/// or a sensor that the rig lacks.
MadeOdometry make_odometry(const OdometryRequest& request, const Rig& rig,
                           const std::string& lidar_id, const Parallel& parallel);

}  // namespace lidarena
