// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/stages/semantic_labels.hpp"

#include <map>

namespace lidarena::stages {
namespace {

// Numbers of semantic-kitti.yaml.
constexpr std::uint16_t kUnlabeled = 0, kPerson = 30, kOtherGround = 49, kBuilding = 50,
                        kOtherStructure = 52, kVegetation = 70, kTrunk = 71, kTerrain = 72,
                        kOtherObject = 99, kMovingPerson = 254, kMovingOtherVehicle = 259;

const std::map<std::string, std::uint16_t>& classes() {
  static const std::map<std::string, std::uint16_t> kClasses = [] {
    std::map<std::string, std::uint16_t> table;
    const auto add = [&table](std::uint16_t label, std::initializer_list<const char*> objects) {
      for (const char* object : objects) table[object] = label;
    };
    add(kOtherGround, {"floor", "rug"});
    add(kBuilding, {"wall", "ceiling", "roof", "window", "door frame", "column", "baseboard"});
    add(kOtherStructure,
        {"stairs", "gallery", "door", "front door", "rack", "truss", "support", "pipe"});
    add(kVegetation, {"leaves", "plant"});
    add(kTrunk, {"trunk"});
    add(kTerrain, {"terrain", "boulder", "rock"});
    return table;
  }();
  return kClasses;
}

}  // namespace

std::uint16_t semantic_class(const std::string& object) {
  if (object.empty()) return kUnlabeled;
  const auto found = classes().find(object);
  return found == classes().end() ? kOtherObject : found->second;
}

std::uint16_t semantic_class(const world::MoverConfig& mover) {
  const bool moves = mover.path.size() > 1;
  switch (mover.kind) {
    case world::MoverKind::kPerson:
      return moves ? kMovingPerson : kPerson;
    case world::MoverKind::kBox:
      return moves ? kMovingOtherVehicle : kOtherObject;
    case world::MoverKind::kDoor:
      break;
  }
  return kOtherObject;
}

std::vector<std::uint32_t> semantic_labels(const world::TriangleMesh& mesh,
                                           const std::vector<world::MoverConfig>& movers) {
  std::vector<std::uint32_t> of_material;
  for (const world::Material& material : mesh.palette)
    of_material.push_back(semantic_class(material.object));
  std::vector<std::uint32_t> labels(mesh.triangles.size(), kUnlabeled);
  for (std::size_t i = 0; i < mesh.material_ids.size(); ++i)
    labels[i] = of_material[mesh.material_ids[i]];
  std::uint32_t instance = 0;
  for (const world::MoverConfig& mover : movers)
    labels.push_back(++instance << 16U | semantic_class(mover));
  return labels;
}

}  // namespace lidarena::stages
