// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <fstream>

#include "apps/lidarena/console.hpp"
#include "apps/lidarena/verbs.hpp"
#include "apps/lidarena/view_server.hpp"
#include "lidarena/dataset/run_manifest.hpp"
#include "lidarena/report/scene_files.hpp"
#include "lidarena/report/web_page.hpp"
#include "lidarena/scenes/load_world.hpp"
#include "lidarena/stages/simulate_dataset.hpp"
#include "lidarena/world/mesh_io.hpp"

namespace lidarena {
namespace {

namespace fs = std::filesystem;

struct ViewOptions {
  std::vector<std::string> files;
  std::string out;
  std::string map = "reprojected";
  double million_points = 5.0;
  int port = 0;
  scenes::WorldOptions world{};
  dataset::ReadOptions read;
};

/// Whether the header of a .ply declares faces; a .ply without faces is a point cloud.
bool has_faces(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  constexpr int kHeaderLines = 1000;
  std::string line;
  for (int i = 0; i < kHeaderLines && std::getline(in, line); ++i) {
    if (line.rfind("element face ", 0) == 0)
      return line.find_first_of("123456789") != std::string::npos;
    if (line.rfind("end_header", 0) == 0) break;
  }
  return false;
}

void add_world(report::Scene& scene, const fs::path& file, const scenes::WorldOptions& options,
               LogSink& log) {
  scene.meshes.push_back({file.stem().string(), scenes::load_world(file, options, log).mesh});
}

/// Adds a folder, a file, or the world called `name` in configs/worlds to the scene.
void add_item(report::Scene& scene, const Common& common, const ViewOptions& o,
              const std::string& name, const report::SceneOptions& options,
              const Parallel& parallel, LogSink& log) {
  fs::path path = name;
  if (!fs::exists(path)) path = common.config_folder().resolve("worlds", name);
  std::string ending = path.extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  const bool is_cloud = ending == ".pcd" || (ending == ".ply" && !has_faces(path));
  if (fs::is_directory(path) && dataset::is_run(path)) {
    report::add_run(scene, path, options, log);
  } else if (fs::is_directory(path) || ending == ".mcap" || ending == ".bag") {
    dataset::Dataset dataset = stages::open_any_dataset(path, o.read, parallel);
    for (const std::string& note : dataset.notes) log.info("note: " + note);
    report::add_dataset(scene, std::move(dataset), options, log);
  } else if (is_cloud) {
    report::add_cloud_file(scene, path, options);
  } else if (ending == ".tum" || ending == ".txt" || ending == ".csv") {
    report::add_path_file(scene, path);
  } else {
    add_world(scene, path, o.world, log);
  }
}

std::string title_of(const std::vector<std::string>& files) {
  std::string title;
  for (const std::string& file : files) {
    const fs::path path = fs::absolute(file).lexically_normal();
    const fs::path name = path.has_filename() ? path.filename() : path.parent_path().filename();
    title += (title.empty() ? "" : ", ") + name.string();
  }
  return title;
}

report::Scene load_scene(const Common& common, const ViewOptions& o, const Parallel& parallel,
                         LogSink& log) {
  report::SceneOptions options;
  options.max_points = static_cast<std::size_t>(o.million_points * 1e6);
  read_value(ConfigNode::parse(o.map, "--map"), options.map, {});
  report::Scene scene;
  scene.title = title_of(o.files);
  for (const std::string& file : o.files) {
    add_item(scene, common, o, file, options, parallel, log);
  }
  report::measure_distances(scene, parallel);
  for (const report::SceneCloud& cloud : scene.clouds) {
    if (cloud.left_out == 0) continue;
    log.info(fmt::format("{}: shows {} of {} points, chosen at random (--points raises the limit)",
                         cloud.name, cloud.points.size(), cloud.points.size() + cloud.left_out));
  }
  return scene;
}

Json summary_of(const report::PackedScene& packed) {
  Json layers = Json::array();
  for (const Json& cloud : packed.header.at("clouds")) {
    layers.push_back({{"cloud", cloud.at("name")},
                      {"points", cloud.at("points")},
                      {"left_out", cloud.at("left_out")}});
  }
  for (const Json& mesh : packed.header.at("meshes")) {
    layers.push_back({{"mesh", mesh.at("name")}, {"triangles", mesh.at("triangles")}});
  }
  for (const Json& path : packed.header.at("paths")) {
    layers.push_back({{"path", path.at("name")}, {"poses", path.at("poses")}});
  }
  return layers;
}

int view_verb(const Common& common, const ViewOptions& o) {
  Console console(common.quiet);
  const report::WebPage page = [&] {
    const Parallel parallel(common.threads);
    const report::Scene scene = load_scene(common, o, parallel, console);
    return report::WebPage{scene.title, "view", {}, {report::pack(scene, parallel)}};
  }();
  const report::PackedScene& packed = page.scenes.front();
  Json summary{{"layers", summary_of(packed)}};
  if (!o.out.empty()) {
    report::write_page(o.out, page);
    summary["page"] = o.out;
    if (common.json) {
      print_json(summary);
    } else {
      fmt::print("{}\n", o.out);
    }
    return kDone;
  }
  serve_view(report::served_page(page), packed, o.port, [&](const std::string& address) {
    summary["address"] = address;
    if (common.json) {
      print_json(summary);
    } else {
      fmt::print("{}\nopen this address in a browser on this machine; Ctrl-C stops the server\n",
                 address);
    }
    std::fflush(stdout);
  });
  return kDone;
}

}  // namespace

void add_view(CLI::App& app, Common& common, int& exit_code) {
  auto* verb = app.add_subcommand(
      "view", "Show clouds, maps, meshes, paths, datasets and runs in 3D in a browser");
  auto o = std::make_shared<ViewOptions>();
  verb->add_option(
          "file", o->files,
          "Clouds (.pcd, .ply), meshes, .tum, .mcap, .bag, DATASET and RUN folders, worlds")
      ->required();
  verb->add_option("--out", o->out,
                   "Self-contained page to write; if not given, a server on 127.0.0.1 shows it");
  verb->add_option("--points", o->million_points, "Maximum number of points per cloud, in millions")
      ->check(CLI::Range(0.001, 1000.0))
      ->capture_default_str();
  verb->add_option("--map", o->map,
                   "Map of a run: reprojected (sampled returns), own (of the algorithm), both, or "
                   "scored (a sample)")
      ->check(CLI::IsMember({"reprojected", "own", "both", "scored"}))
      ->capture_default_str();
  verb->add_option("--port", o->port, "Port of the server, 0 = any free port")
      ->check(CLI::Range(0, 65535))
      ->capture_default_str();
  verb->add_option("--sensor", o->read.sensor,
                   "Id of the only LiDAR of a dataset to show; default: all");
  verb->add_option("--layout", o->read.layout, "Fields of a point in raw binary sweeps")
      ->check(CLI::IsMember({"xyz", "xyzi", "xyzt", "xyztr"}));
  add_allow_missing(*verb, o->world.allow_missing);
  set_verb(
      *verb, common, [&common, o] { return view_verb(common, *o); }, exit_code);
}

}  // namespace lidarena
