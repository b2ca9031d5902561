// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "lidarena/world/triangle_mesh.hpp"

/// SDF's primitive shapes as triangle meshes around their own origin, normals outward. Round shapes
/// are inscribed: the vertices lie on the true surface, and between vertices the mesh is inside it
/// by at most r (1 - cos(pi / 64)), 1.2 mm per meter of radius.
namespace lidarena::world {

constexpr int kSectors = 64;  ///< number of segments around the axis of a round shape
constexpr int kStacks = 32;   ///< number of segments from pole to pole of a sphere

TriangleMesh box_shape(const Eigen::Vector3d& size);
/// Axis along z.
TriangleMesh cylinder_shape(double radius, double length);
TriangleMesh sphere_shape(double radius);
TriangleMesh ellipsoid_shape(const Eigen::Vector3d& radii);
/// A cylinder of `length` between two half spheres; axis along z.
TriangleMesh capsule_shape(double radius, double length);
/// The solid between an outline in the plane z = 0 (a simple polygon) and the same at z = `height`.
TriangleMesh prism_shape(std::vector<Eigen::Vector2d> outline, double height);
/// A rectangle of the given size; SDF's unlimited planes are reduced to their `size`, too.
TriangleMesh plane_shape(const Eigen::Vector3d& normal, const Eigen::Vector2d& size);

}  // namespace lidarena::world
