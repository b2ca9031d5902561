// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <map>
#include <set>

#include "apps/lidarena/console.hpp"
#include "apps/lidarena/pattern_info.hpp"
#include "apps/lidarena/verbs.hpp"
#include "lidarena/dataset/json_file.hpp"
#include "lidarena/dataset/points/cloud.hpp"
#include "lidarena/scenes/load_world.hpp"
#include "lidarena/sensor/sensor_config.hpp"
#include "lidarena/study/simulate_dataset.hpp"

namespace lidarena {
namespace {

namespace fs = std::filesystem;

struct InfoOptions {
  std::string thing;
  std::size_t rays = 0;
  bool pattern = false;
  std::string out;
};

Json sensor_info(const sensor::SensorConfig& sensor) {
  Json json = to_json(sensor);
  const auto pattern = sensor::make_pattern(sensor);
  json["beams_per_scan"] = pattern->beams_per_scan();
  json["points_per_second"] =
      static_cast<double>(pattern->beams_per_scan()) / to_seconds(pattern->period());
  return json;
}

Json box_json(const Eigen::AlignedBox3d& box) {
  return {{"min", value_to_json(Eigen::Vector3d(box.min()))},
          {"max", value_to_json(Eigen::Vector3d(box.max()))}};
}

Json world_info(const fs::path& file, LogSink& log) {
  const world::WorldModel model = scenes::load_world(file, {}, log);
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

Json cloud_info(const fs::path& file) {
  const dataset::Cloud cloud = dataset::read_cloud(file);
  Eigen::AlignedBox3d box;
  std::size_t invalid = 0;
  for (const Eigen::Vector3f& p : cloud.points) {
    if (p.allFinite())
      box.extend(p.cast<double>());
    else
      ++invalid;
  }
  Json json{{"kind", "cloud"}, {"points", cloud.points.size()}, {"not_finite", invalid}};
  if (!box.isEmpty()) json["bounds_m"] = box_json(box);
  return json;
}

/// Reads the whole dataset, so that damage anywhere in it is reported.
Json dataset_info(const fs::path& path) {
  dataset::Dataset dataset = study::open_any_dataset(path, {}, Parallel());
  struct Counts {
    std::size_t messages = 0, points = 0, untimed = 0;
    Time first{0}, last{0}, longest_gap{0};
  };
  std::map<std::string, Counts> topics;
  while (const auto event = dataset.events->next()) {
    const auto* scan = std::get_if<Scan>(&event->data);
    Counts& c = topics[event->sensor_id + (scan != nullptr ? "/points" : "/imu")];
    const Time stamp = scan != nullptr ? scan->stamp : std::get<ImuSample>(event->data).stamp;
    if (c.messages == 0) c.first = stamp;
    if (c.messages > 0) c.longest_gap = std::max(c.longest_gap, stamp - c.last);
    c.last = stamp;
    ++c.messages;
    if (scan == nullptr) continue;
    c.points += scan->points.size();
    c.untimed += scan->timed ? 0 : 1;
  }
  Json json{{"kind", "dataset"}, {"rig", to_json(dataset.rig)}, {"topics", Json::object()}};
  for (const auto& [name, c] : topics) {
    const double seconds = to_seconds(c.last - c.first);
    json["topics"][name] = {
        {"messages", c.messages},
        {"first_s", to_seconds(c.first)},
        {"last_s", to_seconds(c.last)},
        {"rate_hz", seconds > 0 ? static_cast<double>(c.messages - 1) / seconds : 0.0},
        {"longest_gap_s", to_seconds(c.longest_gap)},
        {"points", c.points},
        {"untimed_scans", c.untimed}};
  }
  return json;
}

bool is_mesh_or_world(const fs::path& file) {
  static const std::set<std::string> extensions{".obj", ".stl", ".dae",  ".gltf",
                                                ".glb", ".sdf", ".world"};
  return extensions.contains(file.extension().string());
}

/// Describes a .ply as a mesh if it has faces, else as a cloud.
Json ply_info(const fs::path& file, LogSink& log) {
  try {
    return world_info(file, log);
  } catch (const InputError&) {
    return cloud_info(file);
  }
}

Json info_of(const study::ConfigFolder& configs, const std::string& thing, LogSink& log) {
  const fs::path path = thing;
  if (fs::is_directory(path)) {
    if (fs::exists(path / "manifest.json")) {
      const Json manifest = dataset::read_json(path / "manifest.json");
      if (manifest.value("kind", "") == "run") {
        Json json = manifest;
        if (fs::exists(path / "metrics.json"))
          json["metrics"] = dataset::read_json(path / "metrics.json");
        return json;
      }
    }
    return dataset_info(path);
  }
  if (fs::exists(path)) {
    if (path.extension() == ".ply") return ply_info(path, log);
    if (is_mesh_or_world(path)) return world_info(path, log);
    if (path.extension() == ".mcap" || path.extension() == ".bag") return dataset_info(path);
    if (path.extension() == ".pcd") return cloud_info(path);
  }
  for (const char* kind : {"sensors", "worlds"}) {
    const auto names = configs.names(kind);
    const bool known = std::find(names.begin(), names.end(), thing) != names.end();
    if (!known && !(fs::exists(path) && std::string(kind) == "sensors")) continue;
    const fs::path file = configs.resolve(kind, thing);
    return std::string(kind) == "sensors" ? sensor_info(sensor::load_sensor(file))
                                          : world_info(file, log);
  }
  std::vector<std::string> names = configs.names("sensors");
  for (const std::string& world : configs.names("worlds")) names.push_back(world);
  const std::string nearest = nearest_word(thing, names);
  throw InputError(thing, "is neither a file nor the name of a world or sensor",
                   nearest.empty() ? "see: lidarena list worlds, lidarena list sensors"
                                   : "did you mean '" + nearest + "'?");
}

void print_tree(const Json& json, int depth) {
  for (const auto& [key, value] : json.items()) {
    const std::string indent(static_cast<std::size_t>(2 * depth), ' ');
    if (value.is_object() && !value.empty()) {
      fmt::print("{}{}:\n", indent, key);
      print_tree(value, depth + 1);
    } else {
      const std::string text = value.is_string() ? value.get<std::string>() : value.dump();
      fmt::print("{}{}: {}\n", indent, key, text.size() > 160 ? text.substr(0, 157) + "..." : text);
    }
  }
}

int info_verb(const Common& common, const InfoOptions& o) {
  Console console(common.quiet);
  const study::ConfigFolder configs = common.config_folder();
  if (o.rays > 0) {
    print_rays(sensor::load_sensor(configs.resolve("sensors", o.thing)), o.rays);
    return kDone;
  }
  if (!o.out.empty() && !o.pattern) {
    throw InputError("--out", "is only for the drawing of a scan pattern", "add --pattern");
  }
  const Json json =
      o.pattern ? pattern_info(sensor::load_sensor(configs.resolve("sensors", o.thing)), o.out)
                : info_of(configs, o.thing, console);
  if (common.json) {
    print_json(json);
  } else {
    print_tree(json, 0);
  }
  return kDone;
}

}  // namespace

void add_info(CLI::App& app, Common& common, int& exit_code) {
  auto* verb = app.add_subcommand(
      "info", "Describe a world, sensor, dataset, cloud, mesh or run: sizes, times, rates");
  auto o = std::make_shared<InfoOptions>();
  verb->add_option("thing", o->thing, "Name of a world or sensor, or a path")->required();
  verb->add_option("--rays", o->rays, "Print the first N rays of a sensor as CSV");
  verb->add_flag("--pattern", o->pattern,
                 "Share of a sensor's field of view that its shots cover in 0.1, 0.5, 1 and 4 s");
  verb->add_option("--out", o->out, "With --pattern: SVG file to write the drawing to");
  set_verb(
      *verb, common, [&common, o] { return info_verb(common, *o); }, exit_code);
}

}  // namespace lidarena
