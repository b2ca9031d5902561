// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>

#include "lidarena/world/world.hpp"

namespace lidarena {

/// Is shown triangles that may be near.
class TriangleVisitor {
 public:
  virtual ~TriangleVisitor() = default;
  /// Returns the radius (m) within which triangles still matter; it never grows.
  virtual double visit(std::uint32_t triangle) = 0;
};

/// What World asks of a spatial tree over its mesh. All queries are const and thread safe.
class MeshTree {
 public:
  virtual ~MeshTree() = default;
  /// As World::cast, but the hits' normals stay zero.
  virtual void cast(std::span<const Ray> rays, double max_range, std::span<Hit> hits,
                    RayOrder order) const = 0;
  /// True when a triangle lies between `near` and `far` meters along the ray.
  virtual bool occluded(const Ray& ray, double near, double far) const = 0;
  /// Shows every triangle within the radius (m) around `point`, and some beyond; the radius is that
  /// of the visitor's last answer, at first `radius`.
  virtual void visit_near(const Eigen::Vector3d& point, double radius,
                          TriangleVisitor& visitor) const = 0;
};

}  // namespace lidarena
