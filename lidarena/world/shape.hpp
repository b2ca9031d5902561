// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <memory>

#include "lidarena/world/surfaces.hpp"
#include "lidarena/world/triangle_mesh.hpp"

namespace lidarena {

/// A body in its own frame that rays meet exactly, from outside and from within. Const, thread
/// safe.
class Shape {
 public:
  /// Where a ray meets it first.
  struct Meeting {
    double range = 0.0;                                 ///< m
    Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();  ///< unit, of either side
    std::uint32_t triangle = 0;                         ///< of a mesh; else 0
  };

  virtual ~Shape() = default;
  /// Infinite along the axes where the shape is.
  virtual Eigen::AlignedBox3d bounds() const = 0;
  /// False when the ray meets nothing within `far` meters.
  virtual bool meet(const Ray& ray, double far, Meeting& meeting) const = 0;
};

using ShapePtr = std::shared_ptr<const Shape>;

/// By the primitives' own equations, with no facets. Lengths in meters, above 0.
ShapePtr make_sphere(double radius);
/// Axis along z, closed at both ends; the origin is its middle.
ShapePtr make_cylinder(double radius, double length);
/// The unlimited plane z = 0.
ShapePtr make_plane();
/// The mesh must be clean (see clean_mesh).
ShapePtr make_mesh(TriangleMesh mesh);

/// The mesh of a shape made of one; nullptr for others.
const TriangleMesh* mesh_of(const Shape& shape);

}  // namespace lidarena
