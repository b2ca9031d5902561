// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <functional>
#include <vector>

#include "lidarena/world/triangle_mesh.hpp"

/// Tessellated shapes from which furniture is built. Meters; normals point outward.
namespace lidarena::scenes::shape {

/// Point of a surface at (u, v) in [0, 1]^2.
using Surface = std::function<Eigen::Vector3d(double u, double v)>;

/// nu by nv quads, each split into two triangles, with normals along du x dv.
world::TriangleMesh grid(int nu, int nv, const Surface& surface);

world::TriangleMesh box(const Eigen::Vector3d& low, const Eigen::Vector3d& high);

/// A box of `size` on z = 0, centered in x and y, whose edges are rounded with `radius` and whose
/// faces bulge outward by `bulge` (m) at their centers; cells x cells quads per face.
world::TriangleMesh rounded_box(const Eigen::Vector3d& size, double radius, int cells,
                                double bulge = 0);

/// The surface of revolution about z of a profile of (radius, height) points; a profile that goes
/// upward gives outward normals, and one that starts and ends with radius 0 gives a closed surface.
world::TriangleMesh lathe(const std::vector<Eigen::Vector2d>& profile, int segments);

/// A closed cylinder on z = 0.
world::TriangleMesh cylinder(double radius, double height, int segments, int rings = 1);

/// A ball around the origin.
world::TriangleMesh ball(double radius, int segments);

/// A round bar along a polyline, closed at both ends.
world::TriangleMesh bar(const std::vector<Eigen::Vector3d>& path, double radius, int segments);

/// Points of a circular arc: center + radius (cos a, sin a) for `count` + 1 angles a in [from, to].
std::vector<Eigen::Vector2d> arc(const Eigen::Vector2d& center, double radius, double from,
                                 double to, int count);

world::TriangleMesh translated(world::TriangleMesh mesh, const Eigen::Vector3d& offset);
world::TriangleMesh scaled(world::TriangleMesh mesh, const Eigen::Vector3d& scale);
world::TriangleMesh painted(world::TriangleMesh mesh, const world::Material& material);
world::TriangleMesh rotated(world::TriangleMesh mesh, double angle, const Eigen::Vector3d& axis);

}  // namespace lidarena::scenes::shape
