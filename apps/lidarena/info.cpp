// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "apps/lidarena/console.hpp"
#include "apps/lidarena/pattern_info.hpp"
#include "apps/lidarena/verbs.hpp"
#include "apps/lidarena/yaml_info.hpp"
#include "lidarena/dataset/json_file.hpp"
#include "lidarena/dataset/packets/packet_capture.hpp"
#include "lidarena/dataset/points/cloud.hpp"
#include "lidarena/dataset/run_manifest.hpp"
#include "lidarena/dataset/whole_part.hpp"
#include "lidarena/sensor/sensor_config.hpp"
#include "lidarena/stages/pattern_file.hpp"
#include "lidarena/stages/simulate_dataset.hpp"

namespace lidarena {
namespace {

namespace fs = std::filesystem;

struct InfoOptions {
  std::string thing;
  std::size_t rays = 0;
  bool pattern = false;
  stages::PatternLength length{};
  std::string out;
  dataset::ReadOptions read{};
  scenes::WorldOptions world{};
};

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

Json recorded_topics(const dataset::Dataset& dataset) {
  Json topics = Json::object();
  for (const dataset::TopicSummary& topic : dataset.topics) {
    Json& json = topics[topic.topic];
    json = {{"type", topic.type},
            {"messages", topic.messages},
            {"rate_hz", topic.rate_hz},
            {"read", topic.is_read}};
    if (!topic.frame_id.empty()) json["frame"] = topic.frame_id;
  }
  return topics;
}

/// Reads the whole dataset, so that damage anywhere in it is reported.
Json dataset_info(const fs::path& path, const dataset::ReadOptions& read, LogSink& log) {
  dataset::Dataset dataset = stages::open_any_dataset(path, read, Parallel());
  dataset::tell_opening(dataset, log);
  dataset::read_whole_part(dataset);
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
  dataset::tell_reading(dataset, log);
  Json json{{"kind", "dataset"}, {"rig", to_json(dataset.rig)}, {"topics", Json::object()}};
  if (!dataset.topics.empty()) json["recorded_topics"] = recorded_topics(dataset);
  if (!dataset.report->ended().empty()) json["ended"] = dataset.report->ended();
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

/// Describes a .ply as a mesh if it has faces, else as a cloud.
Json ply_info(const fs::path& file, LogSink& log) {
  try {
    return world_info(file, {}, log);
  } catch (const InputError&) {
    return cloud_info(file);
  }
}

Json folder_info(const fs::path& folder, const dataset::ReadOptions& read, LogSink& log) {
  if (!dataset::is_run(folder)) return dataset_info(folder, read, log);
  Json manifest = to_json(dataset::read_run_manifest(folder));
  if (fs::exists(folder / "metrics.json"))
    manifest["metrics"] = dataset::read_json(folder / "metrics.json");
  return manifest;
}

Json file_info(const fs::path& file, const stages::ConfigFolder& configs, const InfoOptions& o,
               LogSink& log) {
  static const std::set<std::string> worlds{".obj", ".stl", ".dae",  ".gltf",
                                            ".glb", ".sdf", ".world"};
  const std::string ending = file.extension().string();
  if (ending == ".yaml" || ending == ".yml") return yaml_info(file, configs, o.world, log);
  if (ending == ".ply") return ply_info(file, log);
  if (worlds.contains(ending)) return world_info(file, o.world, log);
  if (dataset::is_recording(file) || dataset::is_packet_capture(file))
    return dataset_info(file, o.read, log);
  if (ending == ".pcd") return cloud_info(file);
  throw InputError(
      file.string(), "is of no kind that info describes",
      fmt::format("it describes .yaml, .mcap, .bag, .db3, .pcap, .pcd, .ply, {}, and folders of "
                  "datasets and runs",
                  fmt::join(worlds, ", ")));
}

/// Describes the file or folder `thing`, else what has this name in configs/.
Json info_of(const stages::ConfigFolder& configs, const InfoOptions& o, LogSink& log) {
  if (fs::is_directory(o.thing)) return folder_info(o.thing, o.read, log);
  if (fs::exists(o.thing)) return file_info(o.thing, configs, o, log);
  std::vector<std::string> all;
  for (const char* kind : {"sensors", "worlds", "flights", "studies", "odometry"}) {
    const auto names = configs.names(kind);
    if (std::ranges::find(names, o.thing) != names.end())
      return yaml_info(configs.resolve(kind, o.thing), configs, o.world, log);
    all.insert(all.end(), names.begin(), names.end());
  }
  const std::string nearest = nearest_word(o.thing, all);
  throw InputError(o.thing, "is neither a file nor a name in " + configs.root().string(),
                   nearest.empty() ? "see: lidarena list sensors (or worlds, flights, studies)"
                                   : "did you mean '" + nearest + "'?");
}

/// A value for people: numbers with six digits, large ones (times since 1970) with twelve.
std::string text_of(const Json& value) {
  if (value.is_string()) return value.get<std::string>();
  if (value.is_number_float()) {
    const double number = value.get<double>();
    return std::abs(number) < 1e6 ? fmt::format("{:.6g}", number) : fmt::format("{:.12g}", number);
  }
  if (!value.is_array()) return value.dump();
  std::vector<std::string> items;
  for (const Json& item : value) items.push_back(text_of(item));
  return fmt::format("[{}]", fmt::join(items, ", "));
}

void print_tree(const Json& json, int depth) {
  for (const auto& [key, value] : json.items()) {
    const std::string indent(static_cast<std::size_t>(2 * depth), ' ');
    if (value.is_object() && !value.empty()) {
      fmt::print("{}{}:\n", indent, key);
      print_tree(value, depth + 1);
    } else {
      const std::string text = text_of(value);
      fmt::print("{}{}: {}\n", indent, key, text.size() > 160 ? text.substr(0, 157) + "..." : text);
    }
  }
}

/// Draws the pattern, or writes it as a table, depending on the ending of --out.
Json pattern_json(const sensor::SensorConfig& sensor, const InfoOptions& o) {
  const bool has_length = o.length.scans > 0 || o.length.seconds > 0.0;
  const bool is_table = !o.out.empty() && fs::path(o.out).extension() != ".svg";
  if (has_length && !is_table)
    throw InputError("--scans or --seconds", "is only for the table of a pattern",
                     "add --pattern --out FILE.npy");
  if (!is_table) return pattern_info(sensor, o.out);
  const stages::PatternWritten written = stages::write_pattern(sensor, o.length, o.out);
  return {{"kind", "pattern"},
          {"sensor", sensor.name},
          {"file", o.out},
          {"format", written.format},
          {"scans", written.scans},
          {"shots", written.shots},
          {"repeats_after_scans", written.repeats_after}};
}

int info_verb(const Common& common, const InfoOptions& o) {
  Console console(common.quiet);
  const stages::ConfigFolder configs = common.config_folder();
  if (o.rays > 0) {
    print_rays(configs.load_sensor(o.thing), o.rays);
    return kDone;
  }
  const bool has_length = o.length.scans > 0 || o.length.seconds > 0.0;
  if (!o.pattern && (!o.out.empty() || has_length)) {
    throw InputError(has_length ? "--scans or --seconds" : "--out", "is only for a scan pattern",
                     "add --pattern");
  }
  const Json json =
      o.pattern ? pattern_json(configs.load_sensor(o.thing), o) : info_of(configs, o, console);
  if (common.json) {
    print_json(json);
  } else {
    print_tree(json, 0);
  }
  return json.contains("ended") ? kWorkFailed : kDone;
}

}  // namespace

void add_info(CLI::App& app, Common& common, int& exit_code) {
  auto* verb = app.add_subcommand(
      "info",
      "Describe a world, sensor, flight, study, dataset, cloud, mesh or run: sizes, times, rates");
  auto o = std::make_shared<InfoOptions>();
  verb->add_option("thing", o->thing, "Path, or name of a sensor, world, flight or study")
      ->required();
  verb->add_option("--rays", o->rays, "Print the first N rays of a sensor as CSV");
  verb->add_flag("--pattern", o->pattern,
                 "Share of a sensor's field of view that its shots cover in 0.1, 0.5, 1 and 4 s");
  verb->add_option("--sensor", o->read.sensor, "Id or topic of the only LiDAR to read");
  verb->add_option("--imu-topic", o->read.imu_topic, "Topic of the IMU to read");
  verb->add_option("--out", o->out,
                   "With --pattern: file to write: .svg (a drawing), or the shots as .npy, .csv, "
                   ".mat3x4f (RobotecGPULidar), .usda or .json (Isaac Sim)");
  verb->add_option("--scans", o->length.scans, "Scans of the pattern to write")
      ->check(CLI::PositiveNumber);
  verb->add_option("--seconds", o->length.seconds, "Seconds of the pattern to write")
      ->check(CLI::PositiveNumber);
  add_allow_missing(*verb, o->world.allow_missing);
  set_verb(
      *verb, common, [&common, o] { return info_verb(common, *o); }, exit_code);
}

}  // namespace lidarena
