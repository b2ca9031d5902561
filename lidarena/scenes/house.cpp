// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/scenes/house.hpp"

#include <map>

#include "lidarena/scenes/house_furnish.hpp"
#include "lidarena/scenes/house_plan.hpp"
#include "lidarena/scenes/house_shell.hpp"

namespace lidarena::scenes {
namespace {

/// Main material of a piece of furniture; wood for kinds that are not listed.
const world::Material& material_of(const std::string& kind) {
  using namespace world::materials;
  static const std::map<std::string, const world::Material*> kMaterials{
      {"sofa", &kFabric},
      {"armchair", &kFabric},
      {"beanbag", &kFabric},
      {"bed", &kFabric},
      {"rug", &kFabric},
      {"curtain", &kFabric},
      {"laundry basket", &kFabric},
      {"toy basket", &kFabric},
      {"floor lamp", &kFabric},
      {"table lamp", &kFabric},
      {"pendant lamp", &kFabric},
      {"towel rail", &kFabric},
      {"coat rack", &kFabric},
      {"books", &kPaper},
      {"picture", &kPaper},
      {"plant", &kLeaf},
      {"vase", &kCeramic},
      {"bowl", &kCeramic},
      {"bathtub", &kCeramic},
      {"toilet", &kCeramic},
      {"basin", &kCeramic},
      {"pot", &kMetal},
      {"sink", &kMetal},
      {"stove", &kMetal},
      {"fridge", &kMetal},
      {"washing machine", &kMetal},
      {"bin", &kMetal},
      {"umbrella stand", &kMetal},
      {"column", &kPlaster},
      {"gallery", &kPlaster},
      {"television", &kDarkScreen},
      {"mirror", &kMirror}};
  const auto found = kMaterials.find(kind);
  return found == kMaterials.end() ? kWood : *found->second;
}

}  // namespace

world::WorldModel make_house(const HouseConfig& config, std::uint64_t seed) {
  const HousePlan plan = plan_house(config, seed);
  world::WorldModel model{"house", build_shell(plan, config), {plan.route}};
  for (PlacedObject& object : furnish_house(plan, config, seed)) {
    if (!config.ceilings && object.kind == "pendant lamp") continue;
    object.mesh.paint(material_of(object.kind).of(object.kind));
    model.mesh.append(object.mesh);
  }
  return model;
}

}  // namespace lidarena::scenes
