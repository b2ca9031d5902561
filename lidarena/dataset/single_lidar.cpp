// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/dataset/single_lidar.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>

#include "lidarena/base/error.hpp"

namespace lidarena::dataset {

std::string id_of_topic(std::string topic) {
  constexpr std::string_view kPoints = "/points";
  if (topic.starts_with('/')) topic.erase(0, 1);
  if (topic.ends_with(kPoints)) topic.erase(topic.size() - kPoints.size());
  std::ranges::replace(topic, '/', '_');
  return topic;
}

Rig single_lidar_rig(const std::filesystem::path& path, const ReadOptions& options) {
  LidarInfo lidar;
  lidar.id = "lidar";
  if (!options.sensor.empty() && options.sensor != lidar.id) {
    throw InputError(path.string(), fmt::format("has no LiDAR '{}'", options.sensor),
                     fmt::format("its only LiDAR is '{}'", lidar.id));
  }
  lidar.body_from_lidar = options.body_from_lidar.value_or(Pose::Identity());
  Rig rig;
  rig.lidars.push_back(std::move(lidar));
  return rig;
}

void choose_lidar(const ReadOptions& options, const std::string& place, Rig& rig) {
  std::vector<LidarInfo>& lidars = rig.lidars;
  if (!options.sensor.empty()) {
    std::string known;
    for (const LidarInfo& lidar : lidars) known += (known.empty() ? "" : ", ") + lidar.id;
    std::erase_if(lidars,
                  [&](const LidarInfo& lidar) { return lidar.id != id_of_topic(options.sensor); });
    if (lidars.empty()) {
      throw InputError(place, "has no LiDAR '" + options.sensor + "'", "it has: " + known);
    }
  }
  if (!options.body_from_lidar) return;
  if (lidars.size() != 1) {
    throw InputError(place, "has several LiDARs, but body_from_lidar applies to one",
                     "name the sensor");
  }
  lidars.front().body_from_lidar = *options.body_from_lidar;
}

}  // namespace lidarena::dataset
