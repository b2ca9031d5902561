// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/dataset/dataset_layout.hpp"

#include "lidarena/base/error.hpp"

namespace lidarena::dataset::layout {
namespace {

void add(std::map<std::string, std::string>& topics, const std::string& id, const char* kind) {
  if (!topics.emplace("/" + id + "/" + kind, id).second) {
    throw InputError("rig", "two sensors of the same kind have the id '" + id + "'", "rename one");
  }
}

std::map<std::string, std::string> inverted(const std::map<std::string, std::string>& map) {
  std::map<std::string, std::string> inverse;
  for (const auto& [key, value] : map) inverse.emplace(value, key);
  return inverse;
}

}  // namespace

RecordedSensors topics_of(const Rig& rig) {
  RecordedSensors sensors;
  for (const LidarInfo& lidar : rig.lidars) add(sensors.lidars, lidar.id, "points");
  for (const ImuInfo& imu : rig.imus) add(sensors.imus, imu.id, "imu");
  return sensors;
}

std::string truth_topic_of(const std::string& lidar_id) {
  return kTruthPrefix + lidar_id + "/hits";
}

std::string livox_topic_of(const std::string& lidar_id) { return "/" + lidar_id + "/livox"; }

Json to_json(const RecordedSensors& sensors) {
  Json json{{"lidars", inverted(sensors.lidars)}, {"imus", inverted(sensors.imus)}};
  for (const auto& [id, units] : sensors.imu_units)
    if (units == kInG) json["imus_in_g"].push_back(id);
  return json;
}

RecordedSensors sensors_from_json(const Json& json, const std::string& place) {
  try {
    using Map = std::map<std::string, std::string>;
    RecordedSensors sensors;
    sensors.lidars = inverted(json.at("lidars").get<Map>());
    sensors.imus = inverted(json.at("imus").get<Map>());
    for (const auto& id : json.value("imus_in_g", std::vector<std::string>{}))
      sensors.imu_units[id] = kInG;
    return sensors;
  } catch (const Json::exception&) {
    throw InputError(place, "the list of topics is not {\"lidars\": {id: topic}, \"imus\": {...}}");
  }
}

Rig rig_from_json(const Json& json, const std::string& place) {
  Rig rig;
  read_config(ConfigNode::parse(json.dump(), place + ": rig"), rig);
  return rig;
}

StringMap describe(const Description& description) {
  return {{"format_version", std::to_string(kFormatVersion)},
          {"rig", lidarena::to_json(description.rig).dump()},
          {"topics", to_json(description.sensors).dump()}};
}

std::optional<Description> description_in(const RecordingInfo& info, const std::string& place) {
  const auto record = info.metadata.find(kDescription);
  if (record == info.metadata.end()) return std::nullopt;
  try {
    return Description{rig_from_json(Json::parse(record->second.at("rig")), place),
                       sensors_from_json(Json::parse(record->second.at("topics")), place)};
  } catch (const std::out_of_range&) {
    throw InputError(place, "its 'lidarena' metadata lacks rig or topics");
  } catch (const Json::exception&) {
    throw InputError(place, "its 'lidarena' metadata is not JSON");
  }
}

}  // namespace lidarena::dataset::layout
