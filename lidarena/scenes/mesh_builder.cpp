// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/scenes/mesh_builder.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace lidarena::scenes::shape {
namespace {

using std::numbers::pi;

/// Adds a triangle unless two of its corners coincide (at the poles of a lathe).
void add_triangle(world::TriangleMesh& mesh, std::uint32_t a, std::uint32_t b, std::uint32_t c) {
  const auto same = [&](std::uint32_t i, std::uint32_t j) {
    return mesh.vertices[i] == mesh.vertices[j];
  };
  if (!same(a, b) && !same(b, c) && !same(c, a)) mesh.triangles.push_back({a, b, c});
}

/// Adds quads between consecutive rings of `segments` vertices in `mesh`.
void join_rings(world::TriangleMesh& mesh, std::uint32_t rings, std::uint32_t segments) {
  for (std::uint32_t r = 0; r + 1 < rings; ++r) {
    for (std::uint32_t s = 0; s < segments; ++s) {
      const std::uint32_t a = r * segments + s;
      const std::uint32_t b = r * segments + (s + 1) % segments;
      add_triangle(mesh, a, b, b + segments);
      add_triangle(mesh, a, b + segments, a + segments);
    }
  }
}

}  // namespace

world::TriangleMesh grid(int nu, int nv, const Surface& surface) {
  world::TriangleMesh mesh;
  for (int j = 0; j <= nv; ++j) {
    for (int i = 0; i <= nu; ++i) {
      mesh.vertices.push_back(surface(double(i) / nu, double(j) / nv));
    }
  }
  const auto width = static_cast<std::uint32_t>(nu + 1);
  for (std::uint32_t j = 0; j < static_cast<std::uint32_t>(nv); ++j) {
    for (std::uint32_t i = 0; i + 1 < width; ++i) {
      const std::uint32_t a = j * width + i;
      add_triangle(mesh, a, a + 1, a + width + 1);
      add_triangle(mesh, a, a + width + 1, a + width);
    }
  }
  return mesh;
}

world::TriangleMesh box(const Eigen::Vector3d& low, const Eigen::Vector3d& high) {
  world::TriangleMesh mesh;
  for (unsigned i = 0; i < 8; ++i) {
    mesh.vertices.emplace_back((i & 1U) != 0 ? high.x() : low.x(),
                               (i & 2U) != 0 ? high.y() : low.y(),
                               (i & 4U) != 0 ? high.z() : low.z());
  }
  mesh.triangles = {{0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}, {0, 1, 5}, {0, 5, 4},
                    {2, 6, 7}, {2, 7, 3}, {0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}};
  return mesh;
}

world::TriangleMesh rounded_box(const Eigen::Vector3d& size, double radius, int cells,
                                double bulge) {
  const Eigen::Vector3d half = 0.5 * size;
  const double r = std::min(radius, half.minCoeff());
  const Eigen::Vector3d core = half.array() - r;
  world::TriangleMesh mesh;
  for (int axis = 0; axis < 3; ++axis) {
    for (const double sign : {-1.0, 1.0}) {
      const int a = sign > 0 ? (axis + 1) % 3 : (axis + 2) % 3;
      const int b = 3 - axis - a;
      mesh.append(grid(cells, cells, [&](double u, double v) -> Eigen::Vector3d {
        Eigen::Vector3d q;  // on the sharp-edged box; grid lines are denser near its edges
        q[axis] = sign * half[axis];
        q[a] = std::sin(pi * (u - 0.5)) * half[a];
        q[b] = std::sin(pi * (v - 0.5)) * half[b];
        const Eigen::Vector3d nearest = q.cwiseMax(-core).cwiseMin(core);
        Eigen::Vector3d p = nearest + r * (q - nearest).normalized();
        p[axis] +=
            sign * bulge * (1 - std::pow(q[a] / half[a], 2)) * (1 - std::pow(q[b] / half[b], 2));
        return p + half.z() * Eigen::Vector3d::UnitZ();
      }));
    }
  }
  return mesh;
}

world::TriangleMesh lathe(const std::vector<Eigen::Vector2d>& profile, int segments) {
  world::TriangleMesh mesh;
  for (const Eigen::Vector2d& point : profile) {
    for (int s = 0; s < segments; ++s) {
      const double angle = 2 * pi * s / segments;
      // A zero radius must give identical points, without a difference in the sign of zero.
      const double r = point.x();
      mesh.vertices.emplace_back(r == 0 ? 0 : r * std::cos(angle), r == 0 ? 0 : r * std::sin(angle),
                                 point.y());
    }
  }
  join_rings(mesh, static_cast<std::uint32_t>(profile.size()),
             static_cast<std::uint32_t>(segments));
  return mesh;
}

world::TriangleMesh cylinder(double radius, double height, int segments, int rings) {
  std::vector<Eigen::Vector2d> profile{{0, 0}};
  for (int i = 0; i <= rings; ++i) profile.emplace_back(radius, height * i / rings);
  profile.emplace_back(0, height);
  return lathe(profile, segments);
}

world::TriangleMesh ball(double radius, int segments) {
  std::vector<Eigen::Vector2d> profile = arc({0, 0}, radius, -pi / 2, pi / 2, segments / 2);
  profile.front().x() = profile.back().x() = 0;
  return lathe(profile, segments);
}

world::TriangleMesh bar(const std::vector<Eigen::Vector3d>& path, double radius, int segments) {
  world::TriangleMesh mesh;
  Eigen::Vector3d side = (path[1] - path[0]).unitOrthogonal();
  for (std::size_t i = 0; i < path.size(); ++i) {
    const Eigen::Vector3d along =
        (path[std::min(i + 1, path.size() - 1)] - path[i == 0 ? 0 : i - 1]).normalized();
    side = (side - side.dot(along) * along).normalized();  // transported without twist
    const Eigen::Vector3d other = along.cross(side);
    const bool first = i == 0;
    const bool last = i + 1 == path.size();
    const auto ring = [&](double r) {
      for (int s = 0; s < segments; ++s) {
        const double angle = 2 * pi * s / segments;
        mesh.vertices.push_back(path[i] + r * (std::cos(angle) * side + std::sin(angle) * other));
      }
    };
    if (first) ring(0);
    ring(radius);
    if (last) ring(0);
  }
  join_rings(mesh, static_cast<std::uint32_t>(path.size() + 2),
             static_cast<std::uint32_t>(segments));
  return mesh;
}

std::vector<Eigen::Vector2d> arc(const Eigen::Vector2d& center, double radius, double from,
                                 double to, int count) {
  std::vector<Eigen::Vector2d> points;
  for (int i = 0; i <= count; ++i) {
    const double angle = from + (to - from) * i / count;
    points.emplace_back(center + radius * Eigen::Vector2d(std::cos(angle), std::sin(angle)));
  }
  return points;
}

world::TriangleMesh translated(world::TriangleMesh mesh, const Eigen::Vector3d& offset) {
  for (Eigen::Vector3d& v : mesh.vertices) v += offset;
  return mesh;
}

world::TriangleMesh scaled(world::TriangleMesh mesh, const Eigen::Vector3d& scale) {
  for (Eigen::Vector3d& v : mesh.vertices) v = v.cwiseProduct(scale);
  return mesh;
}

world::TriangleMesh painted(world::TriangleMesh mesh, const world::Material& material) {
  mesh.paint(material);
  return mesh;
}

world::TriangleMesh rotated(world::TriangleMesh mesh, double angle, const Eigen::Vector3d& axis) {
  const Eigen::Matrix3d rotation = Eigen::AngleAxisd(angle, axis).toRotationMatrix();
  for (Eigen::Vector3d& v : mesh.vertices) v = rotation * v;
  return mesh;
}

}  // namespace lidarena::scenes::shape
