// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/world/moving_world.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace lidarena::world {
namespace {

using Eigen::AlignedBox3d;
using Eigen::AlignedBox3f;
using Eigen::Vector3d;

constexpr double kFarAway = 1e30;  // m; limit of infinite boxes, so that they can be rotated

/// The axis-aligned box around a rotated box, enlarged to cover the rounding to single precision.
AlignedBox3f box_in_world(const AlignedBox3d& box, const Pose& world_from_shape) {
  constexpr double kFloatEpsilon = std::numeric_limits<float>::epsilon();
  const Vector3d low = box.min().cwiseMax(-kFarAway), high = box.max().cwiseMin(kFarAway);
  const Vector3d middle = world_from_shape * Vector3d(0.5 * (low + high));
  const Vector3d half = world_from_shape.linear().cwiseAbs() * (0.5 * (high - low));
  const double largest = (middle.cwiseAbs() + half).maxCoeff();
  const Vector3d margin = Vector3d::Constant(4.0 * kFloatEpsilon * std::min(largest, 1e6));
  return {(middle - half - margin).cast<float>(), (middle + half + margin).cast<float>()};
}

}  // namespace

MovingWorld::MovingWorld(std::vector<PlacedShape> shapes) {
  TriangleMesh still;
  std::vector<std::uint32_t> numbers;  // for each triangle of `still`, the index of its shape
  for (std::uint32_t i = 0; i < shapes.size(); ++i) {
    const PlacedShape& placed = shapes[i];
    materials_.push_back(placed.surface);
    const TriangleMesh* mesh = mesh_of(*placed.shape);
    if (mesh != nullptr && !placed.moves) {
      TriangleMesh plain;  // without materials: these are stored per shape
      plain.vertices = mesh->vertices;
      plain.triangles = mesh->triangles;
      still.append(plain, placed.world_from_shape);
      numbers.resize(still.triangles.size(), i);
      continue;
    }
    if (placed.moves) moving_.push_back(bodies_.size());
    add(placed.shape, placed.world_from_shape, {i});
  }
  if (!still.empty()) add(make_mesh(std::move(still)), Pose::Identity(), std::move(numbers));
  if (!boxes_.empty()) tree_ = std::make_unique<BoxTree>(boxes_);
}

void MovingWorld::add(ShapePtr shape, const Pose& pose, std::vector<std::uint32_t> numbers) {
  boxes_.push_back(box_in_world(shape->bounds(), pose));
  bodies_.push_back({std::move(shape), pose, pose.inverse(), std::move(numbers)});
}

void MovingWorld::move(std::span<const Pose> world_from_shapes) {
  if (moving_.empty()) return;
  for (std::size_t i = 0; i < moving_.size(); ++i) {
    Body& body = bodies_[moving_[i]];
    body.world_from_shape = world_from_shapes[i];
    body.shape_from_world = world_from_shapes[i].inverse();
    boxes_[moving_[i]] = box_in_world(body.shape->bounds(), body.world_from_shape);
  }
  tree_->refit(boxes_);
}

Hit MovingWorld::first_hit(const Ray& ray, double max_range) const {
  Hit hit;
  if (!tree_ || !ray.origin.allFinite() || !ray.direction.allFinite()) return hit;
  const Vector3d direction = ray.direction.cast<double>();
  double far = max_range;
  Vector3d normal;
  tree_->walk(BoxTest(ray.origin, direction), 0.0, far, [&](std::uint32_t i) {
    const Body& body = bodies_[i];
    const Ray local{body.shape_from_world * ray.origin,
                    (body.shape_from_world.linear() * direction).cast<float>()};
    Shape::Intersection intersection;
    if (!body.shape->intersect(local, far, intersection)) return;
    const std::uint32_t number = body.number_of(intersection.triangle);
    if (intersection.range == far && number > hit.triangle) return;
    far = intersection.range;
    hit.triangle = number;
    normal = body.world_from_shape.linear() * intersection.normal;
  });
  if (!hit.valid()) return hit;
  hit.range = static_cast<float>(far);
  hit.normal = (normal.dot(direction) > 0.0 ? Vector3d(-normal) : normal).cast<float>();
  return hit;
}

void MovingWorld::cast(std::span<const Ray> rays, double max_range, std::span<Hit> hits,
                       RayOrder /*order*/) const {
  std::transform(rays.begin(), rays.end(), hits.begin(),
                 [&](const Ray& ray) { return first_hit(ray, max_range); });
}

const Material& MovingWorld::material(std::uint32_t shape) const { return materials_[shape]; }

}  // namespace lidarena::world
