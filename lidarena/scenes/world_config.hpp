// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "lidarena/base/config.hpp"
#include "lidarena/scenes/cave.hpp"
#include "lidarena/scenes/forest.hpp"
#include "lidarena/scenes/hall.hpp"
#include "lidarena/scenes/house.hpp"
#include "lidarena/scenes/mine.hpp"
#include "lidarena/scenes/office.hpp"
#include "lidarena/world/mesh_io.hpp"
#include "lidarena/world/mover_config.hpp"
#include "lidarena/world/sdf_world.hpp"

namespace lidarena::scenes {

enum class WorldKind { kHouse, kCave, kMine, kForest, kHall, kOffice, kMesh, kSdf };
constexpr auto enum_names(WorldKind) {
  return std::array{std::pair{"house", WorldKind::kHouse}, std::pair{"cave", WorldKind::kCave},
                    std::pair{"mine", WorldKind::kMine},   std::pair{"forest", WorldKind::kForest},
                    std::pair{"hall", WorldKind::kHall},   std::pair{"office", WorldKind::kOffice},
                    std::pair{"mesh", WorldKind::kMesh},   std::pair{"sdf", WorldKind::kSdf}};
}

/// A world file (see configs/worlds). Each kind has its own keys; keys of another kind are errors.
struct WorldConfig {
  WorldKind kind = WorldKind::kMesh;
  std::uint64_t seed = 1;
  bool vary = false;
  HouseConfig house;
  CaveConfig cave;
  MineConfig mine;
  ForestConfig forest;
  HallConfig hall;
  OfficeConfig office;
  std::string file;
  world::UpAxis up_axis = world::UpAxis::kFile;
  world::ShapeKind shapes = world::ShapeKind::kVisual;
  std::vector<std::string> model_paths;
  bool allow_missing = false;
  world::MaterialSource materials = world::MaterialSource::kDefault;
  std::vector<world::MoverConfig> movers;
  int people = 0;

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("kind", self.kind, "",
      "house, cave, mine, forest, hall, office: procedural; mesh, sdf: from a file");
    v("seed", self.seed, "", "seed of a procedural world");
    v("vary", self.vary, "",
      "draw the procedural world's parameters from the seed; they replace those given here");
    v("house", self.house, "", "parameters of kind house");
    v("cave", self.cave, "", "parameters of kind cave");
    v("mine", self.mine, "", "parameters of kind mine");
    v("forest", self.forest, "", "parameters of kind forest");
    v("hall", self.hall, "", "parameters of kind hall");
    v("office", self.office, "", "parameters of kind office");
    v("file", self.file, "", "the mesh or SDF file, relative to this file");
    v("up_axis", self.up_axis, "", "up axis of a mesh: file (as specified by its format), y or z");
    v("shapes", self.shapes, "", "shapes to load from an SDF world: visual or collision");
    v("model_paths", self.model_paths, "",
      "additional folders to search for model://NAME, relative to this file");
    v("allow_missing", self.allow_missing, "",
      "warn about missing models and meshes and load the world without them, instead of failing");
    v("materials", self.materials, "",
      "of mesh files other than PLY and of SDF's laser_retro: default = each surface diffuse with "
      "50 % reflectivity, file = as stated there");
    v("movers", self.movers, "", "bodies that move: people, doors, boxes");
    v("people", self.people, "",
      "number of people who walk in sight of the flight, drawn from the seed of the noise",
      between(0, 100));
  }
};

}  // namespace lidarena::scenes
