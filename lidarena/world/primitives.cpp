// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/world/primitives.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "lidarena/world/polygon.hpp"

namespace lidarena::world {

using Eigen::Vector2d;
using Eigen::Vector3d;

namespace {

/// Surface of revolution about z of a profile of points (distance from the z axis, z), from the
/// lower pole to the upper. The first and the last point lie on the axis.
TriangleMesh revolve(const std::vector<Vector2d>& profile) {
  TriangleMesh mesh;
  const auto rings = static_cast<std::uint32_t>(profile.size() - 2);
  constexpr auto kRing = static_cast<std::uint32_t>(kSectors);
  for (std::uint32_t ring = 1; ring <= rings; ++ring) {
    for (std::uint32_t sector = 0; sector < kRing; ++sector) {
      const double angle = 2.0 * std::numbers::pi * sector / kRing;
      const double r = profile[ring].x();
      mesh.vertices.emplace_back(r * std::cos(angle), r * std::sin(angle), profile[ring].y());
    }
  }
  const std::uint32_t bottom = rings * kRing, top = bottom + 1;
  mesh.vertices.emplace_back(0, 0, profile.front().y());
  mesh.vertices.emplace_back(0, 0, profile.back().y());
  for (std::uint32_t a = 0; a < kRing; ++a) {
    const std::uint32_t b = (a + 1) % kRing, last = (rings - 1) * kRing;
    mesh.triangles.push_back({bottom, b, a});
    for (std::uint32_t low = 0; low < last; low += kRing) {
      mesh.triangles.push_back({low + a, low + b, low + kRing + b});
      mesh.triangles.push_back({low + a, low + kRing + b, low + kRing + a});
    }
    mesh.triangles.push_back({top, last + a, last + b});
  }
  return mesh;
}

/// Adds points of the half circle around (0, z) at the elevations of the stacks `first` to `last`
/// (of 0 to kStacks).
void add_arc(std::vector<Vector2d>& profile, double radius, double z, int first, int last) {
  for (int stack = first; stack <= last; ++stack) {
    const double elevation = std::numbers::pi * (static_cast<double>(stack) / kStacks - 0.5);
    const bool is_pole = stack == 0 || stack == kStacks;
    profile.emplace_back(is_pole ? 0.0 : radius * std::cos(elevation),
                         z + radius * std::sin(elevation));
  }
}

}  // namespace

TriangleMesh box_shape(const Vector3d& size) {
  TriangleMesh mesh;
  for (unsigned corner = 0; corner < 8; ++corner) {
    const Vector3d side((corner & 1U) != 0 ? 0.5 : -0.5, (corner & 2U) != 0 ? 0.5 : -0.5,
                        (corner & 4U) != 0 ? 0.5 : -0.5);
    mesh.vertices.push_back(side.cwiseProduct(size));
  }
  mesh.triangles = {{0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}, {0, 1, 5}, {0, 5, 4},
                    {2, 6, 7}, {2, 7, 3}, {0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}};
  return mesh;
}

TriangleMesh cylinder_shape(double radius, double length) {
  const double half = 0.5 * length;
  return revolve({{0, -half}, {radius, -half}, {radius, half}, {0, half}});
}

TriangleMesh sphere_shape(double radius) { return ellipsoid_shape(Vector3d::Constant(radius)); }

TriangleMesh ellipsoid_shape(const Vector3d& radii) {
  std::vector<Vector2d> profile;
  add_arc(profile, 1.0, 0.0, 0, kStacks);
  TriangleMesh mesh;
  mesh.append(revolve(profile), Pose::Identity(), radii);
  return mesh;
}

TriangleMesh capsule_shape(double radius, double length) {
  std::vector<Vector2d> profile;
  add_arc(profile, radius, -0.5 * length, 0, kStacks / 2);
  add_arc(profile, radius, 0.5 * length, kStacks / 2, kStacks);
  return revolve(profile);
}

TriangleMesh plane_shape(const Vector3d& normal, const Vector2d& size) {
  const Eigen::Quaterniond turn = Eigen::Quaterniond::FromTwoVectors(Vector3d::UnitZ(), normal);
  TriangleMesh mesh;
  for (const auto& [x, y] : {std::pair(-0.5, -0.5), {0.5, -0.5}, {0.5, 0.5}, {-0.5, 0.5}}) {
    mesh.vertices.push_back(turn * Vector3d(x * size.x(), y * size.y(), 0.0));
  }
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  return mesh;
}

TriangleMesh prism_shape(std::vector<Eigen::Vector2d> outline, double height) {
  if (outline.size() > 1 && outline.front() == outline.back()) outline.pop_back();
  double area = 0.0;  // twice it, positive for a counterclockwise outline
  for (std::size_t i = 0; i < outline.size(); ++i) {
    const Eigen::Vector2d& next = outline[(i + 1) % outline.size()];
    area += outline[i].x() * next.y() - outline[i].y() * next.x();
  }
  if (area < 0.0) std::ranges::reverse(outline);
  const auto n = static_cast<std::uint32_t>(outline.size());
  TriangleMesh mesh;
  for (const double z : {0.0, height}) {
    for (const Eigen::Vector2d& p : outline) mesh.vertices.emplace_back(p.x(), p.y(), z);
  }
  std::vector<std::uint32_t> top(n);
  for (std::uint32_t i = 0; i < n; ++i) {
    const std::uint32_t next = (i + 1) % n;
    mesh.triangles.push_back({i, next, n + next});
    mesh.triangles.push_back({i, n + next, n + i});
    top[i] = n + i;
  }
  if (n < 3) return mesh;
  for (const auto& [a, b, c] : triangulate(top, mesh.vertices)) {
    mesh.triangles.push_back({a, b, c});
    mesh.triangles.push_back({a - n, c - n, b - n});  // the bottom faces down
  }
  return mesh;
}

}  // namespace lidarena::world
