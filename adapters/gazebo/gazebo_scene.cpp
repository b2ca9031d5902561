// SPDX-License-Identifier: BSD-3-Clause
#include "adapters/gazebo/gazebo_scene.hpp"

#include <gazebo/common/CommonIface.hh>
#include <gazebo/common/Console.hh>
#include <gazebo/common/Mesh.hh>
#include <gazebo/common/MeshManager.hh>
#include <gazebo/msgs/msgs.hh>
#include <gazebo/physics/physics.hh>

#include "lidarena/base/error.hpp"
#include "lidarena/world/primitives.hpp"

namespace lidarena::gazebo_plugin {

namespace physics = ::gazebo::physics;
namespace msgs = ::gazebo::msgs;
using Eigen::Vector3d;

namespace {

Vector3d to_vector(const ignition::math::Vector3d& v) { return {v.X(), v.Y(), v.Z()}; }
Vector3d to_vector(const msgs::Vector3d& v) { return {v.x(), v.y(), v.z()}; }

/// All triangles of a mesh file, or of one of its sub-meshes, in mesh coordinates.
world::TriangleMesh triangles_of(const MeshPart& wanted) {
  const auto* mesh = ::gazebo::common::MeshManager::Instance()->Load(wanted.file);
  if (mesh == nullptr) throw InputError(wanted.file, "no mesh found");
  world::TriangleMesh out;
  for (unsigned int s = 0; s < mesh->GetSubMeshCount(); ++s) {
    const auto* part = mesh->GetSubMesh(s);
    if (!wanted.submesh.empty() && part->GetName() != wanted.submesh) continue;
    if (part->GetPrimitiveType() != ::gazebo::common::SubMesh::TRIANGLES) continue;
    const Vector3d origin = wanted.centered && !wanted.submesh.empty()
                                ? Vector3d(0.5 * (to_vector(part->Max()) + to_vector(part->Min())))
                                : Vector3d::Zero();
    append_submesh(
        part->GetVertexCount(), [&](unsigned int i) { return to_vector(part->Vertex(i)); },
        part->GetIndexCount(), [&](unsigned int i) { return part->GetIndex(i); }, origin, out);
  }
  return out;
}

}  // namespace

Pose to_pose(const ignition::math::Pose3d& pose) {
  const auto& q = pose.Rot();
  return make_pose(Eigen::Quaterniond(q.W(), q.X(), q.Y(), q.Z()), to_vector(pose.Pos()));
}

GazeboScene::GazeboScene(physics::WorldPtr world, Geometry geometry, const physics::Link* carrier)
    : world_(std::move(world)), geometry_(geometry), carrier_(carrier), meshes_(triangles_of) {}

bool GazeboScene::has_changed() const {
  const auto models = world_->Models();
  if (models.size() != models_.size()) return true;
  for (std::size_t i = 0; i < models.size(); ++i) {
    const KnownModel& known = models_[i];
    if (models[i].get() != known.model || models[i]->IsStatic() != known.is_static) return true;
    if (known.is_static && models[i]->WorldPose() != known.pose) return true;
  }
  return models.empty();
}

std::shared_ptr<world::MovingWorld> GazeboScene::rebuilt_if_changed() {
  if (!has_changed()) return nullptr;
  models_.clear();
  shapes_.clear();
  moving_.clear();
  for (const auto& model : world_->Models()) {
    models_.push_back({model.get(), model->WorldPose(), model->IsStatic()});
    add_model(model);
  }
  gzmsg << "lidarena: the sensor sees " << shapes_.size() << " shapes, of which " << moving_.size()
        << " may move\n";
  return std::make_shared<world::MovingWorld>(std::move(shapes_));
}

std::vector<Pose> GazeboScene::poses() const {
  std::vector<Pose> poses;
  poses.reserve(moving_.size());
  for (const Moving& shape : moving_) {
    poses.push_back(to_pose(shape.link->WorldPose()) * shape.link_from_shape);
  }
  return poses;
}

void GazeboScene::add_model(const physics::ModelPtr& model) {
  for (const auto& nested : model->NestedModels()) add_model(nested);
  for (const auto& link : model->GetLinks()) {
    if (link.get() == carrier_) continue;
    if (geometry_ == Geometry::kCollision) {
      add_collisions(link, model->IsStatic());
    } else {
      add_visuals(link, model->IsStatic());
    }
  }
}

void GazeboScene::add(const physics::LinkPtr& link, bool is_static, const Pose& link_from_shape,
                      world::ShapePtr shape, const std::string& name) {
  if (!shape) {
    gzwarn << "lidarena: the sensor does not see " << name << ": unsupported kind of shape\n";
    return;
  }
  world::PlacedShape placed;
  placed.shape = std::move(shape);
  placed.world_from_shape = to_pose(link->WorldPose()) * link_from_shape;
  placed.moves = !is_static;
  shapes_.push_back(std::move(placed));
  if (!is_static) moving_.push_back({link, link_from_shape});
}

void GazeboScene::add_collisions(const physics::LinkPtr& link, bool is_static) {
  for (const auto& collision : link->GetCollisions()) {
    const physics::ShapePtr shape = collision->GetShape();
    Pose link_from_shape = to_pose(collision->RelativePose());
    world::ShapePtr ours;
    if (auto box = boost::dynamic_pointer_cast<physics::BoxShape>(shape)) {
      ours = world::make_mesh(world::box_shape(to_vector(box->Size())));
    } else if (auto sphere = boost::dynamic_pointer_cast<physics::SphereShape>(shape)) {
      ours = world::make_sphere(sphere->GetRadius());
    } else if (auto cylinder = boost::dynamic_pointer_cast<physics::CylinderShape>(shape)) {
      ours = world::make_cylinder(cylinder->GetRadius(), cylinder->GetLength());
    } else if (auto plane = boost::dynamic_pointer_cast<physics::PlaneShape>(shape)) {
      link_from_shape = link_from_shape * facing(to_vector(plane->Normal()));
      ours = world::make_plane();  // unlimited, as in ODE
    } else if (auto mesh_shape = boost::dynamic_pointer_cast<physics::MeshShape>(shape)) {
      msgs::Geometry message;
      mesh_shape->FillMsg(message);
      ours = mesh(mesh_shape->GetMeshURI(), message.mesh().submesh(),
                  message.mesh().center_submesh(), to_vector(mesh_shape->Size()));
    }
    add(link, is_static, link_from_shape, std::move(ours), collision->GetScopedName());
  }
}

void GazeboScene::add_visuals(const physics::LinkPtr& link, bool is_static) {
  msgs::Link message;
  link->FillMsg(message);  // the server's own list of visual shapes
  for (const auto& visual : message.visual()) {
    if (!visual.has_geometry()) continue;
    const msgs::Geometry& geometry = visual.geometry();
    const Pose link_from_shape = to_pose(msgs::ConvertIgn(visual.pose()));
    world::ShapePtr ours;
    if (geometry.has_box()) {
      ours = world::make_mesh(world::box_shape(to_vector(geometry.box().size())));
    } else if (geometry.has_sphere()) {
      ours = world::make_sphere(geometry.sphere().radius());
    } else if (geometry.has_cylinder()) {
      ours = world::make_cylinder(geometry.cylinder().radius(), geometry.cylinder().length());
    } else if (geometry.has_plane()) {
      ours = world::make_mesh(
          world::plane_shape(to_vector(geometry.plane().normal()),
                             {geometry.plane().size().x(), geometry.plane().size().y()}));
    } else if (geometry.has_mesh()) {
      const msgs::MeshGeom& g = geometry.mesh();
      ours = mesh(g.filename(), g.submesh(), g.center_submesh(),
                  g.has_scale() ? to_vector(g.scale()) : Vector3d::Ones());
    }
    add(link, is_static, link_from_shape, std::move(ours), visual.name());
  }
}

world::ShapePtr GazeboScene::mesh(const std::string& uri, const std::string& submesh, bool centered,
                                  const Vector3d& scale) {
  const std::string file = ::gazebo::common::find_file(uri);
  try {
    return meshes_.get({file.empty() ? uri : file, submesh, centered, scale});
  } catch (const Error& error) {
    gzerr << "lidarena: " << error.what() << "\n";
    return nullptr;
  }
}

}  // namespace lidarena::gazebo_plugin
