// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>

#include "lidarena/world/world.hpp"

namespace lidarena::world {

/// Callback of MeshTree::visit_near.
class TriangleVisitor {
 public:
  virtual ~TriangleVisitor() = default;
  /// Called for a triangle that may be near. Returns the radius (m) within which further triangles
  /// must be visited; it must not increase from call to call.
  virtual double visit(std::uint32_t triangle) = 0;
};

/// Interface of the spatial trees that World uses. All queries are const and thread-safe.
class MeshTree {
 public:
  virtual ~MeshTree() = default;
  /// As World::cast, but the hits' normals stay zero.
  virtual void cast(std::span<const Ray> rays, double max_range, std::span<Hit> hits,
                    RayOrder order) const = 0;
  /// True when a triangle lies between `near` and `far` meters along the ray.
  virtual bool occluded(const Ray& ray, double near, double far) const = 0;
  /// Calls the visitor for every triangle within a radius (m) of `point`, and for some beyond. The
  /// search starts with `radius` and continues with the radius that the last visit returned.
  virtual void visit_near(const Eigen::Vector3d& point, double radius,
                          TriangleVisitor& visitor) const = 0;
};

}  // namespace lidarena::world
