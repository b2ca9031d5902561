// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "lidarena/world/world.hpp"
#include "lidarena/world/world_model.hpp"

namespace lidarena::python {

/// A world with its model's routes (the model's mesh is moved into `world`).
struct SimulatedWorld {
  explicit SimulatedWorld(world::WorldModel m)
      : model(std::move(m)), world(std::move(model.mesh), model.name) {}
  world::WorldModel model;
  world::World world;
};

}  // namespace lidarena::python
