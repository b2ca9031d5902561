// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/world/world.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "lidarena/base/error.hpp"
#include "lidarena/world/bvh.hpp"
#if LIDARENA_EMBREE_MAJOR > 0
#include "lidarena/world/embree_tree.hpp"
#endif
#include "lidarena/world/group_search.hpp"

namespace lidarena::world {

using Eigen::Vector3d;
using Eigen::Vector3f;

namespace {

#if LIDARENA_EMBREE_MAJOR > 0
constexpr std::array kRayCasters{RayCaster::kEmbree, RayCaster::kBvh};
#else
constexpr std::array kRayCasters{RayCaster::kBvh};
#endif

std::unique_ptr<MeshTree> make_tree(RayCaster caster, const TriangleMesh& mesh,
                                    [[maybe_unused]] const std::string& name) {
  if (caster == RayCaster::kBvh) return std::make_unique<Bvh>(mesh);
#if LIDARENA_EMBREE_MAJOR > 0
  return make_embree_tree(mesh, name);
#else
  throw Error(name + ": Lidarena was built without Embree (LIDARENA_WITH_EMBREE)");
#endif
}

/// The normal, oriented towards the origin of the ray.
Vector3f towards(const Ray& ray, const Vector3f& normal) {
  return normal.dot(ray.direction) > 0.0F ? Vector3f(-normal) : normal;
}

}  // namespace

std::span<const RayCaster> ray_casters() { return kRayCasters; }

struct World::Impl : TriangleTree {
  TriangleMesh mesh;
  Vector3d center;
  std::vector<Vector3f> normals;   ///< unit, one per triangle
  double half_extent;              ///< largest coordinate of the re-centered mesh
  double typical_edge;             ///< m, edge of a square with the triangles' mean area
  std::unique_ptr<MeshTree> tree;  ///< may refer to `mesh`

  ClosestPoint nearest(const Vector3d& point, double max_distance,
                       std::uint32_t guess) const override;
  bool within(const Vector3d& center, double radius, std::size_t limit,
              std::vector<NearTriangle>& found) const override;
};

World::World(TriangleMesh mesh, const std::string& name, RayCaster caster)
    : impl_(std::make_unique<Impl>()) {
  clean_mesh(mesh, name);
  const Eigen::AlignedBox3d box = mesh.bounds();
  impl_->center = box.center();
  impl_->half_extent = 0.5 * box.sizes().maxCoeff();
  impl_->typical_edge = std::sqrt(mesh.area() / static_cast<double>(mesh.triangles.size()));
  impl_->normals.reserve(mesh.triangles.size());
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    impl_->normals.push_back(mesh.cross(i).normalized().cast<float>());
  }
  impl_->mesh = std::move(mesh);
  impl_->tree = make_tree(caster, impl_->mesh, name);
}

World::~World() = default;
World::World(World&&) noexcept = default;
World& World::operator=(World&&) noexcept = default;

const TriangleMesh& World::mesh() const { return impl_->mesh; }

const Material& World::material(std::uint32_t triangle) const {
  return impl_->mesh.material(triangle);
}

bool World::has_retroreflectors() const {
  const auto returns = [](const Material& material) { return material.retro > 0.0; };
  return std::ranges::any_of(impl_->mesh.palette, returns);
}

void World::cast(std::span<const Ray> rays, double max_range, std::span<Hit> hits,
                 RayOrder order) const {
  constexpr std::size_t kBlock = 64;  // rays; their hits stay cached until normals are looked up
  const auto& normals = impl_->normals;
  for (std::size_t first = 0; first < rays.size(); first += kBlock) {
    const auto part = rays.subspan(first, std::min(kBlock, rays.size() - first));
    const auto found = hits.subspan(first, part.size());
    impl_->tree->cast(part, max_range, found, order);
    for (const Hit& hit : found) {  // the normals are scattered in memory
      if (hit.valid()) __builtin_prefetch(&normals[hit.triangle]);
    }
    for (std::size_t i = 0; i < part.size(); ++i) {
      if (found[i].valid()) found[i].normal = towards(part[i], normals[found[i].triangle]);
    }
  }
}

bool World::visible(const Vector3d& a, const Vector3d& b) const {
  constexpr double kFloatEpsilon = std::numeric_limits<float>::epsilon();
  const Vector3d offset = b - a;
  const double length = offset.norm();
  const double reach = std::max((a - impl_->center).lpNorm<Eigen::Infinity>(), length);
  const double slack = 16.0 * kFloatEpsilon * (impl_->half_extent + reach);
  if (length <= 2.0 * slack) return true;
  return !impl_->tree->occluded({a, (offset / length).cast<float>()}, slack, length - slack);
}

namespace {

/// Whether the triangle's box lies farther from `point` than the squared distance, so that the
/// triangle does, too. False also where rounding leaves it open.
bool is_beyond(const Vector3d& point, const Vector3d& a, const Vector3d& b, const Vector3d& c,
               double squared_distance) {
  constexpr double kRounding = 1.0 + 1e-12;
  const Vector3d low = a.cwiseMin(b).cwiseMin(c) - point;
  const Vector3d high = point - a.cwiseMax(b).cwiseMax(c);
  return low.cwiseMax(high).cwiseMax(0.0).squaredNorm() > kRounding * squared_distance;
}

/// Finds the nearest triangle by exact distances to the double-precision mesh.
class Nearest : public TriangleVisitor {
 public:
  Nearest(const TriangleMesh& mesh, const Vector3d& point, double max_distance)
      : mesh_(mesh),
        point_(point),
        distance_(max_distance),
        distance2_(max_distance * max_distance) {}

  /// Of equal distances the lower index is chosen, independent of the order of the visits.
  double visit(std::uint32_t triangle) override {
    const auto& [a, b, c] = mesh_.triangles[triangle];
    const auto& v = mesh_.vertices;
    if (is_beyond(point_, v[a], v[b], v[c], distance2_)) return distance_;
    const Vector3d candidate = closest_point_on_triangle(point_, v[a], v[b], v[c]);
    const double candidate2 = (candidate - point_).squaredNorm();
    const bool is_nearer =
        candidate2 < distance2_ || (candidate2 == distance2_ && triangle < best_.triangle);
    if (!is_nearer) return distance_;
    distance2_ = candidate2;
    distance_ = std::sqrt(candidate2);
    best_ = {candidate, distance_, triangle};
    return distance_;
  }
  double distance() const { return distance_; }
  const ClosestPoint& best() const { return best_; }

 private:
  const TriangleMesh& mesh_;
  Vector3d point_;
  double distance_, distance2_;
  ClosestPoint best_;
};

/// Collects all triangles within a radius; stops when there are more than `limit`.
class Within : public TriangleVisitor {
 public:
  Within(const TriangleMesh& mesh, const Vector3d& center, double radius, std::size_t limit,
         std::vector<NearTriangle>& found)
      : mesh_(mesh), center_(center), radius_(radius), limit_(limit), found_(found) {}

  double visit(std::uint32_t triangle) override {
    if (found_.size() > limit_) return 0.0;  // the rest of the tree need not be searched
    const auto& [a, b, c] = mesh_.triangles[triangle];
    const auto& v = mesh_.vertices;
    if (is_beyond(center_, v[a], v[b], v[c], radius_ * radius_)) return radius_;
    const Vector3d nearest = closest_point_on_triangle(center_, v[a], v[b], v[c]);
    const double distance = (nearest - center_).norm();
    if (distance <= radius_) found_.push_back({distance, triangle});
    return found_.size() > limit_ ? 0.0 : radius_;
  }

 private:
  const TriangleMesh& mesh_;
  Vector3d center_;
  double radius_;
  std::size_t limit_;
  std::vector<NearTriangle>& found_;
};

}  // namespace

ClosestPoint World::Impl::nearest(const Vector3d& point, double max_distance,
                                  std::uint32_t guess) const {
  if (!point.allFinite()) return {};
  Nearest nearest(mesh, point, max_distance);
  if (guess != Hit::kNone) nearest.visit(guess);
  tree->visit_near(point, nearest.distance(), nearest);
  return nearest.best();
}

bool World::Impl::within(const Vector3d& around, double radius, std::size_t limit,
                         std::vector<NearTriangle>& found) const {
  found.clear();
  Within within(mesh, around, radius, limit, found);
  tree->visit_near(around, radius, within);
  return found.size() <= limit;
}

ClosestPoint World::closest_point(const Vector3d& point, double max_distance) const {
  return impl_->nearest(point, max_distance, Hit::kNone);
}

void World::closest_points(std::span<const Vector3d> points, double max_distance,
                           std::span<ClosestPoint> out, const Parallel& parallel) const {
  constexpr std::size_t kBlock = 2048;  // points; a block starts without a guess
  constexpr double kEdgesAcross = 2.0;  // maximum size of a group, see group_search.hpp
  const double group_size = kEdgesAcross * impl_->typical_edge;
  parallel.for_blocks(points.size(), kBlock, [&](std::size_t begin, std::size_t end) {
    GroupSearch(impl_->mesh, *impl_, group_size, max_distance)
        .run(points.subspan(begin, end - begin), out.subspan(begin, end - begin));
  });
}

}  // namespace lidarena::world
