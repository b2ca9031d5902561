// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "lidarena/base/pose.hpp"
#include "lidarena/world/material.hpp"

namespace lidarena::world {

/// Indices of a triangle's corners.
using Triangle = std::array<std::uint32_t, 3>;

/// A triangle soup in meters, world frame, z up. In double precision, so that a mesh far from the
/// origin keeps its accuracy; World re-centers it for the single-precision ray caster.
struct TriangleMesh {
  std::vector<Eigen::Vector3d> vertices;
  std::vector<Triangle> triangles;
  std::vector<Material> palette;  ///< materials in use, at most 256
  std::vector<std::uint8_t>
      material_ids;  ///< indices into `palette`, one per triangle; empty: all Material{}

  bool empty() const { return triangles.empty(); }
  /// Bounding box of the vertices that triangles use.
  Eigen::AlignedBox3d bounds() const;
  /// Sum of the triangles' areas, m^2.
  double area() const;
  /// Twice the area times the unit normal, (b - a) x (c - a), of one triangle.
  Eigen::Vector3d cross(std::size_t triangle) const;
  const Material& material(std::size_t triangle) const {
    return material_ids.empty() ? materials::kDefault : palette[material_ids[triangle]];
  }
  /// Assigns one material to the whole surface.
  void paint(const Material& material);
  /// Adds a transformed copy of `other`: vertices become placement * (scale .* v). If the scale
  /// mirrors, the triangles' winding is reversed so that outward normals stay outward. Throws Error
  /// when the result has more than 256 materials.
  void append(const TriangleMesh& other, const Pose& placement = Pose::Identity(),
              const Eigen::Vector3d& scale = Eigen::Vector3d::Ones());
};

/// Throws InputError (place `name`) when the mesh has no faces, an index out of range, a vertex
/// that is not finite, or materials that do not match its triangles. Removes degenerate triangles
/// (area zero within the rounding of their coordinates) and returns their number; a mesh of
/// degenerate triangles only counts as one without faces.
std::size_t clean_mesh(TriangleMesh& mesh, const std::string& name);

/// Merges vertices with equal coordinates, in order of first use; removes unused vertices.
void merge_vertices(TriangleMesh& mesh);

/// The point of triangle abc nearest to p.
Eigen::Vector3d closest_point_on_triangle(const Eigen::Vector3d& p, const Eigen::Vector3d& a,
                                          const Eigen::Vector3d& b, const Eigen::Vector3d& c);

}  // namespace lidarena::world
