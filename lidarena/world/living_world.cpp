// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/world/living_world.hpp"

#include "lidarena/world/primitives.hpp"

namespace lidarena::world {
namespace {

using Eigen::Vector3d;

constexpr double kDoorThickness = 0.04;  // m

void append_at(TriangleMesh& mesh, const TriangleMesh& part, const Vector3d& place) {
  mesh.append(part, make_pose(Eigen::Matrix3d::Identity(), place));
}

/// Two legs, a trunk, two arms and a head, with the proportions of an adult of that height.
TriangleMesh person_mesh(double height) {
  TriangleMesh mesh;
  const double h = height;
  for (const double side : {-1.0, 1.0}) {
    append_at(mesh, cylinder_shape(0.045 * h, 0.48 * h), {0, side * 0.055 * h, 0.24 * h});
    append_at(mesh, cylinder_shape(0.028 * h, 0.36 * h), {0, side * 0.145 * h, 0.63 * h});
  }
  append_at(mesh, ellipsoid_shape({0.075 * h, 0.115 * h, 0.2 * h}), {0, 0, 0.65 * h});
  append_at(mesh, ellipsoid_shape({0.055 * h, 0.045 * h, 0.07 * h}), {0, 0, 0.93 * h});
  return mesh;
}

TriangleMesh mesh_of_mover(const MoverConfig& mover) {
  TriangleMesh mesh;
  switch (mover.kind) {
    case MoverKind::kPerson:
      return person_mesh(mover.height_m);
    case MoverKind::kDoor: {
      const double width = (mover.path[1] - mover.path[0]).head<2>().norm();
      append_at(mesh, box_shape({width, kDoorThickness, mover.height_m}),
                {0.5 * width, 0, 0.5 * mover.height_m});
      return mesh;
    }
    case MoverKind::kBox:
      break;
  }
  append_at(mesh, box_shape(mover.size), {0, 0, 0.5 * mover.size.z()});
  return mesh;
}

const Material& material_of(MoverKind kind) {
  return kind == MoverKind::kPerson ? materials::kFabric : materials::kWood;
}

}  // namespace

LivingWorld::LivingWorld(const World& still, const std::vector<MoverConfig>& movers)
    : still_(still), still_triangles_(static_cast<std::uint32_t>(still.mesh().triangles.size())) {
  for (const MoverConfig& mover : movers) {
    check_mover(mover, "movers");
    const ShapePtr shape = make_mesh(mesh_of_mover(mover));
    const Eigen::AlignedBox3d box = shape->bounds();
    movers_.push_back(
        {mover, shape, material_of(mover.kind), box.center(), 0.5 * box.diagonal().norm()});
  }
}

void LivingWorld::cast(std::span<const Ray> rays, double max_range, std::span<Hit> hits,
                       RayOrder order) const {
  cast_at(Time{0}, rays, max_range, hits, order);
}

void LivingWorld::cast_at(Time t, std::span<const Ray> rays, double max_range, std::span<Hit> hits,
                          RayOrder order) const {
  still_.cast(rays, max_range, hits, order);
  for (std::uint32_t m = 0; m < movers_.size(); ++m) {
    const Mover& mover = movers_[m];
    const Pose world_from_shape = mover_pose(mover.config, t);
    const Pose shape_from_world = world_from_shape.inverse();
    const Vector3d center = world_from_shape * mover.center;
    for (std::size_t i = 0; i < rays.size(); ++i) {
      const Vector3d direction = rays[i].direction.cast<double>();
      const Vector3d to_center = center - rays[i].origin;
      const double along = to_center.dot(direction);
      const double far = hits[i].valid() ? static_cast<double>(hits[i].range) : max_range;
      if (along < -mover.radius || along - mover.radius > far) continue;
      if (to_center.squaredNorm() - along * along > mover.radius * mover.radius) continue;
      const Ray local{shape_from_world * rays[i].origin,
                      (shape_from_world.linear() * direction).cast<float>()};
      Shape::Intersection found;
      if (!mover.shape->intersect(local, far, found)) continue;
      const Vector3d normal = world_from_shape.linear() * found.normal;
      hits[i].range = static_cast<float>(found.range);
      hits[i].triangle = still_triangles_ + m;
      hits[i].normal = (normal.dot(direction) > 0.0 ? Vector3d(-normal) : normal).cast<float>();
    }
  }
}

const Material& LivingWorld::material(std::uint32_t triangle) const {
  return triangle < still_triangles_ ? still_.material(triangle)
                                     : movers_[triangle - still_triangles_].surface;
}

}  // namespace lidarena::world
