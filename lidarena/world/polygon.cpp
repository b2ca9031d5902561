// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/world/polygon.hpp"

#include <algorithm>

namespace lidarena::world {
namespace {

using Points = std::vector<Eigen::Vector2d>;

/// The corners in the plane of the polygon, counterclockwise, in units of its size.
Points in_plane(std::span<const std::uint32_t> corners, std::span<const Eigen::Vector3d> vertices) {
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();
  const Eigen::Vector3d origin = vertices[corners[0]];
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Eigen::Vector3d a = vertices[corners[i]] - origin;
    const Eigen::Vector3d b = vertices[corners[(i + 1) % corners.size()]] - origin;
    normal += a.cross(b);
  }
  if (normal.norm() == 0.0) return {};
  normal.normalize();
  const Eigen::Vector3d u = normal.unitOrthogonal();
  const Eigen::Vector3d v = normal.cross(u);
  Points points;
  double size = 0.0;
  for (const std::uint32_t corner : corners) {
    const Eigen::Vector3d offset = vertices[corner] - origin;
    points.emplace_back(offset.dot(u), offset.dot(v));
    size = std::max(size, points.back().norm());
  }
  for (Eigen::Vector2d& point : points) point /= size;
  return points;
}

/// Twice the area of a triangle, positive if it turns left.
double turn(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c) {
  return (b - a).x() * (c - a).y() - (b - a).y() * (c - a).x();
}

constexpr double kFlat = 1e-12;  // turns of a polygon of size 1 that are rounding

bool is_convex(const Points& p) {
  for (std::size_t i = 0; i < p.size(); ++i) {
    if (turn(p[i], p[(i + 1) % p.size()], p[(i + 2) % p.size()]) < -kFlat) return false;
  }
  return true;
}

/// Whether the corner at `i` of the rest can be cut off: it turns left, and no other corner of the
/// rest lies in its triangle.
bool is_ear(const Points& p, const std::vector<std::uint32_t>& rest, std::size_t i) {
  const std::uint32_t before = rest[(i + rest.size() - 1) % rest.size()];
  const std::uint32_t after = rest[(i + 1) % rest.size()];
  const Eigen::Vector2d &a = p[before], &b = p[rest[i]], &c = p[after];
  if (turn(a, b, c) <= kFlat) return false;
  return std::ranges::none_of(rest, [&](std::uint32_t other) {
    if (other == before || other == rest[i] || other == after) return false;
    const Eigen::Vector2d& q = p[other];
    const bool is_corner = q == a || q == b || q == c;
    return !is_corner && turn(a, b, q) >= 0.0 && turn(b, c, q) >= 0.0 && turn(c, a, q) >= 0.0;
  });
}

std::vector<Triangle> fan(std::span<const std::uint32_t> corners) {
  std::vector<Triangle> triangles;
  for (std::size_t k = 2; k < corners.size(); ++k)
    triangles.push_back({corners[0], corners[k - 1], corners[k]});
  return triangles;
}

}  // namespace

std::vector<Triangle> triangulate(std::span<const std::uint32_t> corners,
                                  std::span<const Eigen::Vector3d> vertices) {
  if (corners.size() <= 3) return fan(corners);
  const Points points = in_plane(corners, vertices);
  if (points.empty() || is_convex(points)) return fan(corners);
  std::vector<std::uint32_t> rest(corners.size());  // indices into `corners`
  for (std::size_t i = 0; i < rest.size(); ++i) rest[i] = static_cast<std::uint32_t>(i);
  std::vector<Triangle> triangles;
  while (rest.size() >= 3) {
    std::size_t ear = 0;
    while (ear < rest.size() && !is_ear(points, rest, ear)) ++ear;
    if (ear == rest.size()) {  // what is left is flat, or crosses itself
      if (triangles.empty()) return fan(corners);
      break;
    }
    const auto corner = [&](std::size_t i) { return corners[rest[i % rest.size()]]; };
    triangles.push_back({corner(ear + rest.size() - 1), corner(ear), corner(ear + 1)});
    rest.erase(rest.begin() + static_cast<std::ptrdiff_t>(ear));
  }
  return triangles;
}

}  // namespace lidarena::world
