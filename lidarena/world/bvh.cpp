// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/world/bvh.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace lidarena::world {

using Eigen::AlignedBox3d;
using Eigen::AlignedBox3f;
using Eigen::Vector3d;
using Eigen::Vector3f;

namespace {

constexpr double kFloatEpsilon = std::numeric_limits<float>::epsilon();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Margin (m) added to the boxes: covers their rounding to single precision and the rounding of
/// double arithmetic on coordinates far from the origin.
double box_margin(const AlignedBox3d& bounds) {
  const double largest =
      std::max(bounds.min().lpNorm<Eigen::Infinity>(), bounds.max().lpNorm<Eigen::Infinity>());
  return 4.0 * kFloatEpsilon * bounds.sizes().maxCoeff() +
         64.0 * std::numeric_limits<double>::epsilon() * largest;
}

std::vector<AlignedBox3f> triangle_boxes(const TriangleMesh& mesh, const Vector3d& center,
                                         double margin) {
  std::vector<AlignedBox3f> boxes(mesh.triangles.size());
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    AlignedBox3d box;
    for (const std::uint32_t corner : mesh.triangles[i]) box.extend(mesh.vertices[corner]);
    const Vector3d low = box.min() - center, high = box.max() - center;
    boxes[i] = {(low.array() - margin).cast<float>().matrix(),
                (high.array() + margin).cast<float>().matrix()};
  }
  return boxes;
}

/// Watertight ray-triangle test. In coordinates in which the ray is the z axis, the origin lies to
/// the left or to the right of each edge. Two triangles that share an edge compute the same value
/// for it except for the sign, so a ray cannot pass outside both. This requires that products are
/// rounded before they are subtracted: see -ffp-contract in CMakeLists.txt.
struct TriangleTest {
  Vector3d origin;
  int x, y, z;  ///< axes; the ray's direction is largest along z
  double shear_x, shear_y, scale;

  TriangleTest(const Vector3d& from, const Vector3d& direction) : origin(from) {
    direction.cwiseAbs().maxCoeff(&z);
    x = (z + 1) % 3;
    y = (z + 2) % 3;
    shear_x = direction[x] / direction[z];
    shear_y = direction[y] / direction[z];
    scale = 1.0 / direction[z];
  }

  Vector3d sheared(const Vector3d& vertex) const {
    const Vector3d v = vertex - origin;
    return {v[x] - shear_x * v[z], v[y] - shear_y * v[z], scale * v[z]};
  }

  /// Range of the hit; negative or NaN when the ray does not hit the triangle.
  double range(const Vector3d& corner_a, const Vector3d& corner_b, const Vector3d& corner_c) const {
    const Vector3d a = sheared(corner_a), b = sheared(corner_b), c = sheared(corner_c);
    const double u = c.x() * b.y() - c.y() * b.x();
    const double v = a.x() * c.y() - a.y() * c.x();
    const double w = b.x() * a.y() - b.y() * a.x();
    const bool some_left = u < 0.0 || v < 0.0 || w < 0.0;
    const bool some_right = u > 0.0 || v > 0.0 || w > 0.0;
    if (some_left == some_right) return -1.0;  // outside, or seen edge-on
    return (u * a.z() + v * b.z() + w * c.z()) / (u + v + w);
  }
};

bool can_hit(const Ray& ray) {
  return ray.origin.allFinite() && ray.direction.allFinite() && !ray.direction.isZero(0.0F);
}

}  // namespace

Bvh::Bvh(const TriangleMesh& mesh)
    : mesh_(mesh),
      center_(mesh.bounds().center()),
      tree_(triangle_boxes(mesh, center_, box_margin(mesh.bounds()))) {}

/// Calls `on_hit(triangle, range)` for every triangle that the ray hits between the ranges `near`
/// and `far`, roughly in order of range. `on_hit` may reduce `far` to end the search sooner.
template <typename OnHit>
void Bvh::walk(const Ray& ray, double near, double& far, const OnHit& on_hit) const {
  if (!can_hit(ray)) return;
  const Vector3d direction = ray.direction.cast<double>();
  const TriangleTest triangles(ray.origin, direction);
  tree_.walk(BoxTest(ray.origin - center_, direction), near, far, [&](std::uint32_t triangle) {
    const auto& [a, b, c] = mesh_.triangles[triangle];
    const auto& v = mesh_.vertices;
    const double range = triangles.range(v[a], v[b], v[c]);
    if (range >= near && range <= far) on_hit(triangle, range);
  });
}

std::pair<double, std::uint32_t> Bvh::first_hit(const Ray& ray, double max_range) const {
  std::uint32_t first = Hit::kNone;
  double far = max_range;
  walk(ray, 0.0, far, [&](std::uint32_t triangle, double range) {
    if (range == far && triangle > first) return;
    far = range;
    first = triangle;
  });
  return {far, first};
}

void Bvh::cast(std::span<const Ray> rays, double max_range, std::span<Hit> hits,
               RayOrder /*order*/) const {
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const auto [range, triangle] = first_hit(rays[i], max_range);
    hits[i] = Hit{};
    if (triangle != Hit::kNone) hits[i] = {static_cast<float>(range), triangle, hits[i].normal};
  }
}

bool Bvh::occluded(const Ray& ray, double near, double far) const {
  bool is_blocked = false;
  walk(ray, near, far, [&](std::uint32_t /*triangle*/, double /*range*/) {
    is_blocked = true;
    far = -kInfinity;  // one hit is enough: ends the search
  });
  return is_blocked;
}

void Bvh::visit_near(const Vector3d& point, double radius, TriangleVisitor& visitor) const {
  if (!point.allFinite()) return;
  const Vector3d centered = point - center_;
  const auto widened2 = [](double r) { return r * r * (1.0 + 8.0 * kFloatEpsilon); };
  tree_.visit_near(centered, widened2(radius),
                   [&](std::uint32_t triangle) { return widened2(visitor.visit(triangle)); });
}

}  // namespace lidarena::world
