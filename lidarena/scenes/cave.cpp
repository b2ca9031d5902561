// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/scenes/cave.hpp"

#include <functional>

#include "lidarena/scenes/cave_field.hpp"
#include "lidarena/scenes/cave_graph.hpp"
#include "lidarena/scenes/surface_nets.hpp"

namespace lidarena::scenes {

world::WorldModel make_cave(const CaveConfig& config, std::uint64_t seed) {
  const CaveGraph graph = make_cave_graph(config, seed);
  const CaveField rock(graph, config, seed);
  SparseField samples = rock.sample();
  make_well_composed(samples);
  world::WorldModel model{"cave", surface_net(samples), {cave_route(graph)}};
  project_onto_surface(model.mesh, std::cref(rock), config.voxel_size_m);
  model.mesh.paint(world::materials::kRock.of("rock"));
  return model;
}

}  // namespace lidarena::scenes
