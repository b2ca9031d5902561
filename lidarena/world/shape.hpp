// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <memory>

#include "lidarena/world/surfaces.hpp"
#include "lidarena/world/triangle_mesh.hpp"

namespace lidarena::world {

/// A body in its own frame with exact ray intersections, from outside and from inside. Const,
/// thread-safe.
class Shape {
 public:
  /// First intersection of a ray with the body.
  struct Intersection {
    double range = 0.0;                                 ///< m
    Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();  ///< unit, of either orientation
    std::uint32_t triangle = 0;                         ///< index in a mesh; otherwise 0
  };

  virtual ~Shape() = default;
  /// Bounding box; infinite along the axes along which the shape is infinite.
  virtual Eigen::AlignedBox3d bounds() const = 0;
  /// Returns false when the ray does not intersect the body within `far` meters.
  virtual bool intersect(const Ray& ray, double far, Intersection& intersection) const = 0;
};

using ShapePtr = std::shared_ptr<const Shape>;

/// Analytic shapes, not tessellated. Lengths in meters, above 0.
ShapePtr make_sphere(double radius);
/// Axis along z, closed at both ends; the origin is its center.
ShapePtr make_cylinder(double radius, double length);
/// The unlimited plane z = 0.
ShapePtr make_plane();
/// The mesh must be clean (see clean_mesh).
ShapePtr make_mesh(TriangleMesh mesh);

/// The mesh of a shape created by make_mesh(); nullptr for others.
const TriangleMesh* mesh_of(const Shape& shape);

}  // namespace lidarena::world
