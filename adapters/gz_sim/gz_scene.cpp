// SPDX-License-Identifier: BSD-3-Clause
#include "adapters/gz_sim/gz_scene.hpp"

#include <algorithm>
#include <mutex>
#include <sdf/Box.hh>
#include <sdf/Capsule.hh>
#include <sdf/Cylinder.hh>
#include <sdf/Ellipsoid.hh>
#include <sdf/Mesh.hh>
#include <sdf/Plane.hh>
#include <sdf/Sphere.hh>

#include "lidarena/base/error.hpp"
#include "lidarena/world/primitives.hpp"

namespace lidarena::gz_sim_plugin {

using Eigen::Vector3d;
using gazebo_plugin::MeshPart;

namespace {

/// All triangles of a mesh file, or of one of its sub-meshes, in mesh coordinates. Systems run in
/// parallel and the simulator's meshes are shared: one at a time.
world::TriangleMesh triangles_of(const MeshPart& wanted) {
  static std::mutex mutex;
  const std::lock_guard lock(mutex);
  const gz::common::Mesh* mesh = gz::common::MeshManager::Instance()->Load(wanted.file);
  if (mesh == nullptr) throw InputError(wanted.file, "no mesh found");
  world::TriangleMesh out;
  for (unsigned int s = 0; s < mesh->SubMeshCount(); ++s) {
    const auto part = mesh->SubMeshByIndex(s).lock();
    if (!part || (!wanted.submesh.empty() && part->Name() != wanted.submesh)) continue;
    if (part->SubMeshPrimitiveType() != gz::common::SubMesh::TRIANGLES) continue;
    const Vector3d origin = wanted.centered && !wanted.submesh.empty()
                                ? Vector3d(0.5 * (to_vector(part->Max()) + to_vector(part->Min())))
                                : Vector3d::Zero();
    gazebo_plugin::append_submesh(
        part->VertexCount(), [&](unsigned int i) { return to_vector(part->Vertex(i)); },
        part->IndexCount(), [&](unsigned int i) { return part->Index(i); }, origin, out);
  }
  return out;
}

/// Whether a shape of this kind (Visual or Collision) appeared or was removed in this step.
template <class Kind>
bool has_news(const sim::EntityComponentManager& ecm) {
  bool news = false;
  const auto note = [&](const sim::Entity&, const Kind*, const components::Geometry*) {
    news = true;
    return false;  // one is enough
  };
  ecm.EachNew<Kind, components::Geometry>(note);
  if (!news) ecm.EachRemoved<Kind, components::Geometry>(note);
  return news;
}

/// The shapes of this kind, without those whose removal was asked for.
template <class Kind>
std::vector<sim::Entity> shapes_in(const sim::EntityComponentManager& ecm) {
  std::vector<sim::Entity> all, removed, kept;
  const auto to = [](std::vector<sim::Entity>& list) {
    return [&list](const sim::Entity& entity, const Kind*, const components::Geometry*) {
      list.push_back(entity);
      return true;
    };
  };
  ecm.Each<Kind, components::Geometry>(to(all));
  ecm.EachRemoved<Kind, components::Geometry>(to(removed));
  std::sort(all.begin(), all.end());
  std::sort(removed.begin(), removed.end());
  std::set_difference(all.begin(), all.end(), removed.begin(), removed.end(),
                      std::back_inserter(kept));
  return kept;
}

}  // namespace

GzScene::GzScene(Geometry geometry, sim::Entity carrier)
    : geometry_(geometry), carrier_(carrier), meshes_(triangles_of) {}

std::shared_ptr<world::MovingWorld> GzScene::rebuilt_if_changed(
    const sim::EntityComponentManager& ecm) {
  const std::optional<Entities> changed = changed_shapes(ecm);
  if (!changed && !has_static_moved(ecm)) return nullptr;
  if (changed) known_ = *changed;
  is_built_ = true;
  static_models_.clear();
  shapes_.clear();
  moving_.clear();
  for (const sim::Entity shape : known_) add(shape, ecm);
  print_message("the sensor sees " + std::to_string(shapes_.size()) + " shapes, of which " +
                std::to_string(moving_.size()) + " may move");
  return std::make_shared<world::MovingWorld>(std::move(shapes_));
}

std::vector<Pose> GzScene::poses(const sim::EntityComponentManager& ecm) const {
  std::vector<Pose> poses;
  poses.reserve(moving_.size());
  for (const Moving& shape : moving_) {
    poses.push_back(to_pose(sim::worldPose(shape.link, ecm)) * shape.link_from_shape);
  }
  return poses;
}

/// The shapes of the world if they are not the known ones. Looks at all of them only after one
/// appeared or was removed, or the number of the world's entities changed.
std::optional<GzScene::Entities> GzScene::changed_shapes(const sim::EntityComponentManager& ecm) {
  const bool is_visual = geometry_ == Geometry::kVisual;
  const bool news =
      is_visual ? has_news<components::Visual>(ecm) : has_news<components::Collision>(ecm);
  const std::size_t count = ecm.EntityCount();
  if (is_built_ && !news && count == entity_count_) return std::nullopt;
  entity_count_ = count;
  Entities shapes =
      is_visual ? shapes_in<components::Visual>(ecm) : shapes_in<components::Collision>(ecm);
  if (is_built_ && shapes == known_) return std::nullopt;
  return shapes;
}

/// Static models are moved by commands alone, which the simulator marks as one-time changes.
bool GzScene::has_static_moved(const sim::EntityComponentManager& ecm) const {
  if (!ecm.HasOneTimeComponentChanges()) return false;
  return std::any_of(static_models_.begin(), static_models_.end(), [&](const StaticModel& model) {
    const auto* pose = ecm.Component<components::Pose>(model.entity);
    return pose != nullptr && pose->Data() != model.pose;
  });
}

/// Whether the model of this link can move; remembers where it is if not.
bool GzScene::moves(sim::Entity link, const sim::EntityComponentManager& ecm) {
  const sim::Entity model = sim::topLevelModel(link, ecm);
  const auto* is_static = ecm.Component<components::Static>(model);
  if (is_static == nullptr || !is_static->Data()) return true;
  const bool is_known =
      std::any_of(static_models_.begin(), static_models_.end(),
                  [&](const StaticModel& known) { return known.entity == model; });
  if (!is_known) static_models_.push_back({model, sim::worldPose(model, ecm)});
  return false;
}

void GzScene::add(sim::Entity shape, const sim::EntityComponentManager& ecm) {
  const sim::Entity link = ecm.ParentEntity(shape);
  const auto* geometry = ecm.Component<components::Geometry>(shape);
  const auto* pose = ecm.Component<components::Pose>(shape);
  if (link == carrier_ || geometry == nullptr || pose == nullptr) return;
  Moving placement{link, to_pose(pose->Data())};
  world::PlacedShape placed;
  try {
    placed.shape = shape_of(geometry->Data(), placement.link_from_shape);
  } catch (const Error& error) {
    print_error(error.what());
  }
  if (!placed.shape) {
    return print_warning("the sensor does not see " + sim::scopedName(shape, ecm, "::", false));
  }
  placed.world_from_shape = to_pose(sim::worldPose(link, ecm)) * placement.link_from_shape;
  placed.moves = moves(link, ecm);
  if (placed.moves) moving_.push_back(placement);
  shapes_.push_back(std::move(placed));
}

/// nullptr if this kind of shape is not supported.
world::ShapePtr GzScene::shape_of(const sdf::Geometry& geometry, Pose& link_from_shape) {
  switch (geometry.Type()) {
    case sdf::GeometryType::BOX:
      return world::make_mesh(world::box_shape(to_vector(geometry.BoxShape()->Size())));
    case sdf::GeometryType::SPHERE:
      return world::make_sphere(geometry.SphereShape()->Radius());
    case sdf::GeometryType::CYLINDER:
      return world::make_cylinder(geometry.CylinderShape()->Radius(),
                                  geometry.CylinderShape()->Length());
    case sdf::GeometryType::CAPSULE:
      return world::make_mesh(world::capsule_shape(geometry.CapsuleShape()->Radius(),
                                                   geometry.CapsuleShape()->Length()));
    case sdf::GeometryType::ELLIPSOID:
      return world::make_mesh(
          world::ellipsoid_shape(to_vector(geometry.EllipsoidShape()->Radii())));
    case sdf::GeometryType::PLANE: {
      const sdf::Plane& plane = *geometry.PlaneShape();
      const Vector3d normal = to_vector(plane.Normal());
      if (geometry_ == Geometry::kVisual) {
        return world::make_mesh(world::plane_shape(normal, {plane.Size().X(), plane.Size().Y()}));
      }
      link_from_shape = link_from_shape * gazebo_plugin::facing(normal);
      return world::make_plane();  // unlimited, as in the physics engine
    }
    case sdf::GeometryType::MESH: {
      const sdf::Mesh& mesh = *geometry.MeshShape();
      return meshes_.get({sim::asFullPath(mesh.Uri(), mesh.FilePath()), mesh.Submesh(),
                          mesh.CenterSubmesh(), to_vector(mesh.Scale())});
    }
    default:
      return nullptr;
  }
}

}  // namespace lidarena::gz_sim_plugin
