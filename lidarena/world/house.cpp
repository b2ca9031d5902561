// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/world/house.hpp"

#include "lidarena/world/house_furnish.hpp"
#include "lidarena/world/house_plan.hpp"
#include "lidarena/world/house_shell.hpp"

namespace lidarena {

WorldModel make_house(const HouseConfig& config, std::uint64_t seed) {
  const HousePlan plan = plan_house(config, seed);
  WorldModel model{"house", build_shell(plan, config), {plan.route}};
  for (const PlacedObject& object : furnish_house(plan, config, seed)) {
    model.mesh.append(object.mesh);
  }
  return model;
}

}  // namespace lidarena
