// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/scenes/load_world.hpp"

#include <algorithm>
#include <cctype>

#include "lidarena/base/config_json.hpp"
#include "lidarena/scenes/drawn_scene.hpp"
#include "lidarena/scenes/world_config.hpp"

namespace lidarena::scenes {

namespace fs = std::filesystem;

namespace {

std::string ending_of(const fs::path& file) {
  std::string ending = file.extension().string();
  std::ranges::transform(ending, ending.begin(),
                         [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return ending;
}

std::vector<std::string> keys_of(WorldKind kind) {
  switch (kind) {
    case WorldKind::kHouse:
      return {"kind", "seed", "vary", "house"};
    case WorldKind::kCave:
      return {"kind", "seed", "vary", "cave"};
    case WorldKind::kMine:
      return {"kind", "seed", "vary", "mine"};
    case WorldKind::kForest:
      return {"kind", "seed", "vary", "forest"};
    case WorldKind::kHall:
      return {"kind", "seed", "vary", "hall"};
    case WorldKind::kOffice:
      return {"kind", "seed", "vary", "office"};
    case WorldKind::kMesh:
      return {"kind", "file", "up_axis"};
    case WorldKind::kSdf:
      break;
  }
  return {"kind", "file", "shapes", "model_paths", "allow_missing"};
}

WorldConfig read_world_config(const fs::path& file, const std::vector<std::string>& set) {
  const ConfigNode node = ConfigNode::load(file);
  WorldConfig config;
  read_config(node, config);
  if (!node.is_map() || !node.find("kind")) {
    throw InputError(file.string(), "the key 'kind' is missing",
                     "set kind to house, cave, mine, forest, hall, office, mesh or sdf");
  }
  std::vector<std::string> keys = keys_of(config.kind);
  keys.insert(keys.end(), {"movers", "people"});
  node.reject_unknown(keys);
  for (const std::string& assignment : set) {
    ConfigNode::parse(assignment_as_yaml(assignment), "--set " + assignment).reject_unknown(keys);
    set_field(config, assignment);
  }
  for (const world::MoverConfig& mover : config.movers) world::check_mover(mover, file.string());
  const bool needs_file = config.kind == WorldKind::kMesh || config.kind == WorldKind::kSdf;
  if (needs_file && config.file.empty()) {
    throw InputError(file.string(), "the key 'file' is missing",
                     "set file to the path of the mesh or SDF file, relative to this file");
  }
  return config;
}

world::SdfOptions sdf_options(const WorldConfig& config, const fs::path& base,
                              const WorldOptions& options) {
  world::SdfOptions sdf{options.shapes.value_or(config.shapes),
                        {},
                        options.allow_missing || config.allow_missing,
                        config.materials};
  for (const std::string& path : config.model_paths) sdf.model_paths.push_back(base / path);
  sdf.model_paths.insert(sdf.model_paths.end(), options.model_paths.begin(),
                         options.model_paths.end());
  return sdf;
}

/// The world file with what its seed draws, and `options.set` over both.
WorldConfig drawn_config(const fs::path& file, const WorldOptions& options) {
  WorldConfig config = read_world_config(file, options.set);
  config.seed = options.seed.value_or(config.seed);
  if (config.vary) {
    config.house = drawn_house(config.house, config.seed);
    config.cave = drawn_cave(config.cave, config.seed);
    config.mine = drawn_mine(config.mine, config.seed);
    config.forest = drawn_forest(config.forest, config.seed);
    config.hall = drawn_hall(config.hall, config.seed);
    config.office = drawn_office(config.office, config.seed);
  }
  for (const std::string& assignment : options.set) set_field(config, assignment);
  return config;
}

world::WorldModel load_configured(const fs::path& file, const WorldOptions& options, LogSink& log) {
  const WorldConfig config = drawn_config(file, options);
  const fs::path base = file.parent_path();
  world::WorldModel model;
  switch (config.kind) {
    case WorldKind::kHouse:
      model = make_house(config.house, config.seed);
      break;
    case WorldKind::kCave:
      model = make_cave(config.cave, config.seed);
      break;
    case WorldKind::kMine:
      model = make_mine(config.mine, config.seed);
      break;
    case WorldKind::kForest:
      model = make_forest(config.forest, config.seed);
      break;
    case WorldKind::kHall:
      model = make_hall(config.hall, config.seed);
      break;
    case WorldKind::kOffice:
      model = make_office(config.office, config.seed);
      break;
    case WorldKind::kMesh:
      model.mesh = world::load_mesh(base / config.file, config.up_axis, config.materials);
      break;
    case WorldKind::kSdf:
      model.mesh = world::load_sdf(base / config.file, sdf_options(config, base, options), log);
      break;
  }
  model.movers = config.movers;
  model.people = config.people;
  return model;
}

bool is_world_file(const fs::path& file) {
  const std::string ending = ending_of(file);
  return ending == ".yaml" || ending == ".yml";
}

}  // namespace

Json world_config(const fs::path& file, const std::vector<std::string>& set) {
  if (is_world_file(file)) return to_json(read_world_config(file, set));
  if (set.empty()) return Json::object();
  throw InputError("--set world." + set.front(), file.string() + " has no keys",
                   "name the mesh in a world file (.yaml) and vary that");
}

world::WorldModel load_world(const fs::path& file, const WorldOptions& options, LogSink& log) {
  const std::string ending = ending_of(file);
  std::error_code ignored;
  if (!fs::is_regular_file(file, ignored)) {
    throw InputError(file.string(), "there is no such file", "check the path");
  }
  world::WorldModel model;
  if (!is_world_file(file)) world_config(file, options.set);
  if (is_world_file(file)) {
    model = load_configured(file, options, log);
  } else if (ending == ".sdf" || ending == ".world") {
    model.mesh = world::load_sdf(file, sdf_options({}, {}, options), log);
  } else if (world::is_mesh_file(file)) {
    model.mesh = world::load_mesh(file);
  } else {
    throw InputError(file.string(), "this file extension is not that of a world",
                     "use .yaml, .sdf, .world, .obj, .ply, .stl, .dae, .gltf or .glb");
  }
  model.name = file.stem().string();
  return model;
}

}  // namespace lidarena::scenes
