// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <optional>
#include <sdf/Geometry.hh>
#include <vector>

#include "adapters/gazebo/plugin/mesh_shapes.hpp"
#include "adapters/gazebo/plugin/plugin_config.hpp"
#include "adapters/gz_sim/gz_sim.hpp"
#include "lidarena/world/moving_world.hpp"

namespace lidarena::gz_sim_plugin {

using gazebo_plugin::Geometry;

/// The shapes of a running world as a MovingWorld, without a rendering engine: planes, boxes,
/// spheres, cylinders, meshes with their scale, sub-mesh and centering; capsules and ellipsoids as
/// meshes (see world/primitives.hpp). Others (heightmaps, polylines) are reported on the console
/// and left out. Use it in every PostUpdate: models that appear or vanish are seen once each.
class GzScene {
 public:
  /// `carrier`: the link that carries the sensor; the sensor does not see it.
  GzScene(Geometry geometry, sim::Entity carrier);

  /// A new MovingWorld if shapes appeared or vanished or a static model was moved; else nullptr. A
  /// shape whose removal was asked for in this step is gone.
  std::shared_ptr<world::MovingWorld> rebuilt_if_changed(const sim::EntityComponentManager& ecm);
  /// Poses of the shapes that may move, as MovingWorld::move() takes them.
  std::vector<Pose> poses(const sim::EntityComponentManager& ecm) const;

 private:
  using Entities = std::vector<sim::Entity>;
  struct StaticModel {
    sim::Entity entity;
    gz::math::Pose3d pose;  ///< when the world was built
  };
  struct Moving {
    sim::Entity link;
    Pose link_from_shape;
  };

  std::optional<Entities> changed_shapes(const sim::EntityComponentManager& ecm);
  bool has_static_moved(const sim::EntityComponentManager& ecm) const;
  void add(sim::Entity shape, const sim::EntityComponentManager& ecm);
  bool moves(sim::Entity link, const sim::EntityComponentManager& ecm);
  world::ShapePtr shape_of(const sdf::Geometry& geometry, Pose& link_from_shape);

  Geometry geometry_;
  sim::Entity carrier_;
  std::size_t entity_count_ = 0;  ///< of the world, after the last step
  Entities known_;                ///< visuals or collisions, increasing
  std::vector<StaticModel> static_models_;
  std::vector<world::PlacedShape> shapes_;  ///< while building
  std::vector<Moving> moving_;
  gazebo_plugin::MeshShapes meshes_;
  bool is_built_ = false;
};

}  // namespace lidarena::gz_sim_plugin
