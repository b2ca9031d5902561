// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gazebo/physics/PhysicsTypes.hh>
#include <ignition/math/Pose3.hh>
#include <memory>
#include <string>
#include <vector>

#include "adapters/gazebo/plugin/mesh_shapes.hpp"
#include "adapters/gazebo/plugin/plugin_config.hpp"
#include "lidarena/world/moving_world.hpp"

namespace lidarena::gazebo_plugin {

Pose to_pose(const ignition::math::Pose3d& pose);

/// The shapes of a Gazebo world as a MovingWorld, without a rendering engine: planes, boxes,
/// spheres, cylinders, and meshes with their scale, sub-mesh and centering. Others (heightmaps,
/// polylines) are reported on Gazebo's console and left out. Use only within the world's update.
class GazeboScene {
 public:
  /// `carrier`: the link that carries the sensor; the sensor does not see it.
  GazeboScene(::gazebo::physics::WorldPtr world, Geometry geometry,
              const ::gazebo::physics::Link* carrier);

  /// A new MovingWorld if models were added or removed or a static one was moved; else nullptr.
  std::shared_ptr<world::MovingWorld> rebuilt_if_changed();
  /// Poses of the shapes that may move, as MovingWorld::move() takes them.
  std::vector<Pose> poses() const;

 private:
  struct KnownModel {
    const ::gazebo::physics::Model* model;
    ignition::math::Pose3d pose;  ///< when the world was built
    bool is_static;
  };
  struct Moving {
    ::gazebo::physics::LinkPtr link;
    Pose link_from_shape;
  };

  bool has_changed() const;
  void add_model(const ::gazebo::physics::ModelPtr& model);
  void add_collisions(const ::gazebo::physics::LinkPtr& link, bool is_static);
  void add_visuals(const ::gazebo::physics::LinkPtr& link, bool is_static);
  void add(const ::gazebo::physics::LinkPtr& link, bool is_static, const Pose& link_from_shape,
           world::ShapePtr shape, const std::string& name);
  world::ShapePtr mesh(const std::string& uri, const std::string& submesh, bool centered,
                       const Eigen::Vector3d& scale);  ///< nullptr if there is none

  ::gazebo::physics::WorldPtr world_;
  Geometry geometry_;
  const ::gazebo::physics::Link* carrier_;
  std::vector<KnownModel> models_;
  std::vector<world::PlacedShape> shapes_;  ///< while building
  std::vector<Moving> moving_;
  MeshShapes meshes_;
};

}  // namespace lidarena::gazebo_plugin
