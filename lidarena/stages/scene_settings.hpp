// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "lidarena/base/config_json.hpp"

namespace lidarena::stages {

/// Settings of a simulation by what they are of, without the first word of their keys.
struct SceneSettings {
  std::vector<std::string> world, flight;
  std::vector<std::vector<std::string>> sensors;  ///< of each sensor
};

/// Splits "KIND.key=value" by KIND: `world`, `flight`, `sensor` (each sensor), `imu` (that inside
/// each sensor), or the name of one sensor, the stem of its file. Throws InputError for another
/// KIND.
SceneSettings scene_settings(const std::vector<std::string>& set,
                             const std::vector<std::filesystem::path>& sensors);

/// "key=value", with the value as YAML.
std::string assignment_of(const std::string& key, const Json& value);

}  // namespace lidarena::stages
