// SPDX-License-Identifier: BSD-3-Clause
#include "apps/lidarena/yaml_info.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "apps/lidarena/schema.hpp"
#include "lidarena/flight/flight_config.hpp"
#include "lidarena/odometry/factory.hpp"
#include "lidarena/sensor/sensor_config.hpp"
#include "lidarena/study/improvement.hpp"
#include "lidarena/study/study_spec.hpp"

namespace lidarena {
namespace {

namespace fs = std::filesystem;

/// Whether a file with this schema may have `key` with the value it has in `node`.
bool has_place_for(const Json& schema, const ConfigNode& node, const std::string& key) {
  const Json& properties = schema.at("properties");
  if (!properties.contains(key)) return false;
  const Json& field = properties.at(key);
  if (!field.contains("enum")) return true;
  const auto value = node.find(key);
  if (value->is_map() || value->is_list()) return false;
  const Json& values = field.at("enum");
  return std::find(values.begin(), values.end(), value->text()) != values.end();
}

bool is_algorithm(const std::string& kind) {
  const auto all = odometry::list_algorithms();
  return std::ranges::find(all, kind, &odometry::AlgorithmInfo::name) != all.end();
}

/// The kinds of file, named as their schemas, that have a place for most keys of `node`; none if no
/// kind has a place for any.
std::vector<std::string> nearest_kinds(const ConfigNode& node) {
  std::vector<std::string> nearest;
  std::ptrdiff_t most = 1;
  for (const auto& [kind, make] : schemas()) {
    if (kind == "metrics" || kind == "report" || kind == "run" || kind == "dataset")
      continue;  // JSON files
    const Json schema = make();
    const auto count = std::ranges::count_if(
        node.keys(), [&](const std::string& key) { return has_place_for(schema, node, key); });
    if (count > most) nearest.clear();
    if (count >= most) nearest.push_back(kind);
    most = std::max(most, count);
  }
  return nearest;
}

Json sensor_info(const sensor::SensorConfig& sensor) {
  Json json = to_json(sensor);
  const auto pattern = sensor::make_pattern(sensor);
  json["beams_per_scan"] = pattern->beams_per_scan();
  json["points_per_second"] =
      static_cast<double>(pattern->beams_per_scan()) / to_seconds(pattern->period());
  return json;
}

Json beams_info(const sensor::SpinningHead& head) {
  const auto [low, high] = std::ranges::minmax(head.beams, {}, &sensor::HeadBeam::elevation_deg);
  return {{"kind", "beams"},
          {"beams", head.beams.size()},
          {"elevation_min_deg", low.elevation_deg},
          {"elevation_max_deg", high.elevation_deg},
          {"clockwise", head.clockwise},
          {"column_period_us", head.column_period_us}};
}

Json study_info(const fs::path& file, const stages::ConfigFolder& configs) {
  const study::StudySpec spec = study::load_study(file);
  return {{"kind", "study"},
          {"runs", study::planned_cells(spec, configs).size()},
          {"study", to_json(spec)}};
}

[[noreturn]] void reject(const fs::path& file, const ConfigNode& node,
                         const std::vector<std::string>& kinds) {
  const std::string keys = fmt::format("{}", fmt::join(node.keys(), ", "));
  if (kinds.empty()) {
    throw InputError(
        file.string(),
        "what it describes does not follow from its keys (" + keys +
            "): tried as world, flight, sensor, beams, study, recording, steps, external "
            "program and settings of each algorithm",
        "lidarena schema KIND prints the keys of a kind");
  }
  throw InputError(file.string(),
                   fmt::format("what it describes does not follow from its keys ({}), which fit "
                               "several kinds of file: {}",
                               keys, fmt::join(kinds, ", ")),
                   "lidarena schema KIND prints the keys of a kind");
}

}  // namespace

Json box_json(const Eigen::AlignedBox3d& box) {
  return {{"min", value_to_json(Eigen::Vector3d(box.min()))},
          {"max", value_to_json(Eigen::Vector3d(box.max()))}};
}

Json world_info(const fs::path& file, const scenes::WorldOptions& options, LogSink& log) {
  const world::WorldModel model = scenes::load_world(file, options, log);
  Json routes = Json::array();
  for (const auto& route : model.routes) {
    double length = 0.0;
    for (std::size_t i = 1; i < route.size(); ++i) length += (route[i] - route[i - 1]).norm();
    routes.push_back({{"points", route.size()}, {"length_m", length}});
  }
  return {{"kind", "world"},
          {"triangles", model.mesh.triangles.size()},
          {"vertices", model.mesh.vertices.size()},
          {"area_m2", model.mesh.area()},
          {"bounds_m", box_json(model.mesh.bounds())},
          {"routes", routes}};
}

Json yaml_info(const fs::path& file, const stages::ConfigFolder& configs,
               const scenes::WorldOptions& options, LogSink& log) {
  const ConfigNode node = ConfigNode::load(file);
  if (!node.is_map()) throw InputError(file.string(), "holds no keys (key: value)");
  const std::vector<std::string> kinds = nearest_kinds(node);
  if (!kinds.empty() && std::ranges::all_of(kinds, is_algorithm))
    return {{"kind", "odometry"}, {"algorithms", kinds}, {"keys", node.keys()}};
  if (kinds.size() != 1) reject(file, node, kinds);
  const std::string& kind = kinds.front();
  if (kind == "world") return world_info(file, options, log);
  if (kind == "sensor") return sensor_info(configs.load_sensor(file.string()));
  if (kind == "beams") return beams_info(sensor::load_spinning_head(file));
  if (kind == "study") return study_info(file, configs);
  if (kind == "steps")
    return {{"kind", kind},
            {"steps", to_json(load_config<study::ImprovementSteps>(file))["steps"]}};
  if (kind == "recording")
    return {{"kind", kind}, {"recording", to_json(load_config<study::StudyRecording>(file))}};
  if (kind == "flight")
    return {{"kind", kind}, {"flight", to_json(load_config<flight::FlightConfig>(file))}};
  return {{"kind", "external program"},
          {"program", to_json(load_config<stages::ExternalProgram>(file))}};
}

}  // namespace lidarena
