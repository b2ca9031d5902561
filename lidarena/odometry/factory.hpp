// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "lidarena/base/config_json.hpp"
#include "lidarena/base/parallel.hpp"
#include "lidarena/base/rig.hpp"
#include "lidarena/odometry/odometry.hpp"

namespace lidarena::odometry {

/// Which odometry to build, and its settings.
struct OdometryRequest {
  std::string algorithm;                 ///< one of the names of list_algorithms()
  std::string preset{};                  ///< one of its presets; empty: the default one
  std::string config_file{};             ///< YAML, applied after the preset; empty: none
  std::vector<std::string> overrides{};  ///< "key=value", applied last
};

struct AlgorithmInfo {
  std::string name;
  std::string summary;
  std::vector<std::string> presets;  ///< the default first; our own methods have none
  bool needs_imu = false;
  bool takes_several_lidars = false;  ///< its scans may have the points of several
};

/// All algorithms, from an explicit table.
std::vector<AlgorithmInfo> list_algorithms();

/// JSON Schema of the configuration file of the algorithm `name`. Throws InputError for an unknown
/// name.
Json algorithm_schema(const std::string& name);

/// The request with the name of the default preset if it names none and the algorithm is known and
/// has presets.
OdometryRequest with_default_preset(OdometryRequest request);

/// Throws InputError for an unknown algorithm or preset, naming the nearest or, for a former
/// preset, its successor.
void check_algorithm(const OdometryRequest& request);

/// Throws InputError for an algorithm whose scans are those of one LiDAR alone.
void check_takes_several_lidars(const std::string& algorithm);

/// The complete configuration that the request gives for a LiDAR; without one, for a LiDAR of which
/// nothing is known. Throws InputError as check_algorithm(), and for a bad configuration.
Json configuration_of(const OdometryRequest& request, const LidarInfo& lidar = {});

/// Scans in which each sweep is handed over to the method, by the request's preset; 1 without one.
/// Throws InputError as check_algorithm().
int parts_of(const OdometryRequest& request);

struct MadeOdometry {
  std::unique_ptr<Odometry> odometry;
  Json config;  ///< the complete configuration, for the manifest
};

/// Builds an odometry for the LiDAR `lidar_id` of `rig` (empty: its only one).
/// Throws InputError as check_algorithm(), and for a bad configuration or a sensor that the rig
/// lacks.
MadeOdometry make_odometry(const OdometryRequest& request, const Rig& rig,
                           const std::string& lidar_id, const Parallel& parallel);

}  // namespace lidarena::odometry
