// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/stages/scene_settings.hpp"

namespace lidarena::stages {

SceneSettings scene_settings(const std::vector<std::string>& set,
                             const std::vector<std::filesystem::path>& sensors) {
  SceneSettings settings;
  settings.sensors.resize(sensors.size());
  for (const std::string& assignment : set) {
    const std::string key = assignment.substr(0, assignment.find('='));
    const std::string kind = key.substr(0, key.find('.'));
    const std::string rest = assignment.substr(std::min(kind.size() + 1, assignment.size()));
    bool is_known = key.size() > kind.size() + 1;
    if (is_known && kind == "world") {
      settings.world.push_back(rest);
    } else if (is_known && kind == "flight") {
      settings.flight.push_back(rest);
    } else if (is_known) {
      is_known = kind == "sensor" || kind == "imu";
      for (std::size_t i = 0; i < sensors.size(); ++i) {
        const bool is_named = sensors[i].stem() == kind;
        is_known = is_known || is_named;
        if (kind == "imu") settings.sensors[i].push_back(assignment);
        if (kind == "sensor" || is_named) settings.sensors[i].push_back(rest);
      }
    }
    if (!is_known)
      throw InputError("--set " + assignment, "does not say what it is a setting of",
                       "write world.KEY=VALUE, flight.KEY, sensor.KEY, imu.KEY or SENSOR.KEY");
  }
  return settings;
}

std::string assignment_of(const std::string& key, const Json& value) {
  return key + "=" + value.dump();
}

}  // namespace lidarena::stages
