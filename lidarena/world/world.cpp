// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/world/world.hpp"

// The only file that knows Embree, and which of its two versions is here.
#if LIDARENA_EMBREE_MAJOR >= 4
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif
#include <tbb/task_arena.h>

#include <cmath>
#include <vector>

#include "lidarena/base/error.hpp"
#include "lidarena/world/group_search.hpp"

namespace lidarena {

using Eigen::Vector3d;
using Eigen::Vector3f;

namespace {

constexpr double kFloatEpsilon = std::numeric_limits<float>::epsilon();

/// Embree's handles are reference counted; the device outlives its scene.
struct DeviceRelease {
  void operator()(RTCDevice device) const { rtcReleaseDevice(device); }
};
struct SceneRelease {
  void operator()(RTCScene scene) const { rtcReleaseScene(scene); }
};
using Device = std::unique_ptr<std::remove_pointer_t<RTCDevice>, DeviceRelease>;
using Scene = std::unique_ptr<std::remove_pointer_t<RTCScene>, SceneRelease>;

void check(RTCDevice device, const std::string& name) {
  const RTCError error = rtcGetDeviceError(device);
  if (error == RTC_ERROR_NONE) return;
  throw Error(name + ": the ray caster failed (" +
              (error == RTC_ERROR_OUT_OF_MEMORY ? "out of memory"
                                                : "Embree error " + std::to_string(error)) +
              ")");
}

Scene build_scene(RTCDevice device, const TriangleMesh& mesh, const Vector3d& centre) {
  RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
  auto* vertices = static_cast<float*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0,
                                                               RTC_FORMAT_FLOAT3, 3 * sizeof(float),
                                                               mesh.vertices.size()));
  auto* indices = static_cast<std::uint32_t*>(
      rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                              sizeof(Triangle), mesh.triangles.size()));
  Scene scene(rtcNewScene(device));
  if (vertices != nullptr && indices != nullptr) {
    for (const Vector3d& v : mesh.vertices) {
      for (int axis = 0; axis < 3; ++axis) *vertices++ = static_cast<float>(v[axis] - centre[axis]);
    }
    for (const Triangle& triangle : mesh.triangles) {
      indices = std::copy(triangle.begin(), triangle.end(), indices);
    }
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene.get(), geometry);
    rtcSetSceneFlags(scene.get(), RTC_SCENE_FLAG_ROBUST);  // no ray slips between two triangles
    // One thread: which of two triangles a ray through their common edge reports depends on the
    // tree, and the tree on the number of builders.
    tbb::task_arena(1).execute([&] { rtcJoinCommitScene(scene.get()); });
  }
  rtcReleaseGeometry(geometry);
  return scene;
}

#if LIDARENA_EMBREE_MAJOR >= 4
struct Caster {
  RTCScene scene;
  void intersect(RTCRayHit& ray) { rtcIntersect1(scene, &ray); }
  void intersect(const int* valid, RTCRayHit8& rays) {
    RTCIntersectArguments arguments;
    rtcInitIntersectArguments(&arguments);
    arguments.flags = RTC_RAY_QUERY_FLAG_COHERENT;
    rtcIntersect8(valid, scene, &rays, &arguments);
  }
  void occlude(RTCRay& ray) { rtcOccluded1(scene, &ray); }
};
#else
struct Caster {
  RTCScene scene;
  RTCIntersectContext context;
  explicit Caster(RTCScene s) : scene(s) { rtcInitIntersectContext(&context); }
  void intersect(RTCRayHit& ray) { rtcIntersect1(scene, &context, &ray); }
  void intersect(const int* valid, RTCRayHit8& rays) {
    context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    rtcIntersect8(valid, scene, &context, &rays);
  }
  void occlude(RTCRay& ray) { rtcOccluded1(scene, &context, &ray); }
};
#endif

RTCRay make_ray(const Vector3d& origin, const Vector3f& direction, float near, float far) {
  RTCRay ray{};
  ray.org_x = static_cast<float>(origin.x());
  ray.org_y = static_cast<float>(origin.y());
  ray.org_z = static_cast<float>(origin.z());
  ray.dir_x = direction.x();
  ray.dir_y = direction.y();
  ray.dir_z = direction.z();
  ray.tnear = near;
  ray.tfar = far;
  ray.mask = std::numeric_limits<unsigned>::max();
  return ray;
}

}  // namespace

struct World::Impl : TriangleTree {
  TriangleMesh mesh;
  Vector3d centre;
  std::vector<Vector3f> normals;  ///< unit, one a triangle
  double half_extent;             ///< largest coordinate of the re-centred mesh
  double typical_edge;            ///< m, of a square of a triangle's mean area
  Device device;
  Scene scene;

  ClosestPoint nearest(const Vector3d& point, double max_distance,
                       std::uint32_t guess) const override;
  bool within(const Vector3d& centre, double radius, std::size_t limit,
              std::vector<NearTriangle>& found) const override;
  double slack_at(const Vector3d& centred) const;
};

World::World(TriangleMesh mesh, const std::string& name) : impl_(std::make_unique<Impl>()) {
  clean_mesh(mesh, name);
  const Eigen::AlignedBox3d box = mesh.bounds();
  impl_->centre = box.center();
  impl_->half_extent = 0.5 * box.sizes().maxCoeff();
  impl_->typical_edge = std::sqrt(mesh.area() / static_cast<double>(mesh.triangles.size()));
  impl_->normals.reserve(mesh.triangles.size());
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    impl_->normals.push_back(mesh.cross(i).normalized().cast<float>());
  }
  impl_->device.reset(rtcNewDevice(nullptr));
  check(impl_->device.get(), name);
  impl_->scene = build_scene(impl_->device.get(), mesh, impl_->centre);
  check(impl_->device.get(), name);
  impl_->mesh = std::move(mesh);
}

World::~World() = default;
World::World(World&&) noexcept = default;
World& World::operator=(World&&) noexcept = default;

const TriangleMesh& World::mesh() const { return impl_->mesh; }

namespace {

/// The side of a face that a ray meets.
Vector3f towards(const Ray& ray, const Vector3f& normal) {
  return normal.dot(ray.direction) > 0.0F ? Vector3f(-normal) : normal;
}

/// Eight rays in the form that Embree follows together; lanes without a ray are left alone.
struct Packet {
  static constexpr std::size_t kSize = 8;
  alignas(32) int valid[kSize];
  RTCRayHit8 query;

  Packet() {
    for (std::size_t i = 0; i < kSize; ++i) {
      query.ray.tnear[i] = query.ray.time[i] = 0.0F;
      query.ray.mask[i] = std::numeric_limits<unsigned>::max();
      query.ray.flags[i] = 0;
      query.hit.instID[0][i] = RTC_INVALID_GEOMETRY_ID;
    }
  }

  /// Takes one to eight rays.
  void load(std::span<const Ray> rays, const Vector3d& centre, float far) {
    for (std::size_t i = 0; i < kSize; ++i) {
      valid[i] = i < rays.size() ? -1 : 0;
      const Ray& ray = rays[std::min(i, rays.size() - 1)];
      query.ray.org_x[i] = static_cast<float>(ray.origin.x() - centre.x());
      query.ray.org_y[i] = static_cast<float>(ray.origin.y() - centre.y());
      query.ray.org_z[i] = static_cast<float>(ray.origin.z() - centre.z());
      query.ray.dir_x[i] = ray.direction.x();
      query.ray.dir_y[i] = ray.direction.y();
      query.ray.dir_z[i] = ray.direction.z();
      query.ray.tfar[i] = far;
      query.hit.geomID[i] = RTC_INVALID_GEOMETRY_ID;
    }
  }
};

}  // namespace

void World::cast(std::span<const Ray> rays, double max_range, std::span<Hit> hits,
                 RayOrder order) const {
  if (order == RayOrder::kNeighbours) return cast_packets(rays, max_range, hits);
  Caster caster{impl_->scene.get()};
  const auto far = static_cast<float>(max_range);
  RTCRayHit query{};
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const Ray& ray = rays[i];
    query.ray = make_ray(ray.origin - impl_->centre, ray.direction, 0.0F, far);
    query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    caster.intersect(query);
    if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) {
      hits[i] = Hit{};
      continue;
    }
    hits[i] = {query.ray.tfar, query.hit.primID, towards(ray, impl_->normals[query.hit.primID])};
  }
}

void World::cast_packets(std::span<const Ray> rays, double max_range, std::span<Hit> hits) const {
  Caster caster{impl_->scene.get()};
  const auto far = static_cast<float>(max_range);
  Packet packet;
  for (std::size_t first = 0; first < rays.size(); first += Packet::kSize) {
    const auto together = rays.subspan(first, std::min(Packet::kSize, rays.size() - first));
    packet.load(together, impl_->centre, far);
    caster.intersect(packet.valid, packet.query);
    for (std::size_t i = 0; i < together.size(); ++i) {
      const bool is_hit = packet.query.hit.geomID[i] != RTC_INVALID_GEOMETRY_ID;
      hits[first + i] =
          is_hit ? Hit{packet.query.ray.tfar[i], packet.query.hit.primID[i], Vector3f::Zero()}
                 : Hit{};
      if (is_hit) __builtin_prefetch(&impl_->normals[packet.query.hit.primID[i]]);
    }
  }
  // The normals lie far apart in memory: by now they have been fetched.
  for (std::size_t i = 0; i < rays.size(); ++i) {
    if (hits[i].valid()) hits[i].normal = towards(rays[i], impl_->normals[hits[i].triangle]);
  }
}

bool World::visible(const Vector3d& a, const Vector3d& b) const {
  const Vector3d way = b - a;
  const double length = way.norm();
  const double reach = std::max((a - impl_->centre).lpNorm<Eigen::Infinity>(), length);
  const double slack = 16.0 * kFloatEpsilon * (impl_->half_extent + reach);
  if (length <= 2.0 * slack) return true;
  RTCRay ray = make_ray(a - impl_->centre, (way / length).cast<float>(), static_cast<float>(slack),
                        static_cast<float>(length - slack));
  Caster{impl_->scene.get()}.occlude(ray);
  return ray.tfar >= 0.0F;  // Embree marks an occluded ray by -infinity
}

/// How far the tree's float boxes may be from the truth: rounding of the point, of the vertices,
/// and of Embree's own arithmetic on their differences.
double World::Impl::slack_at(const Vector3d& centred) const {
  return 8.0 * kFloatEpsilon * (half_extent + centred.lpNorm<Eigen::Infinity>());
}

namespace {

/// Radius that surely holds everything as near as `distance`.
float search_radius(double distance, double slack) {
  return static_cast<float>(distance * (1.0 + 4.0 * kFloatEpsilon) + slack);
}

RTCPointQuery point_query(const Vector3d& centred, double distance, double slack) {
  RTCPointQuery query{};
  query.x = static_cast<float>(centred.x());
  query.y = static_cast<float>(centred.y());
  query.z = static_cast<float>(centred.z());
  query.radius = search_radius(distance, slack);
  return query;
}

using Consider = bool(RTCPointQueryFunctionArguments*);

void walk(RTCScene scene, RTCPointQuery query, Consider* consider, void* state) {
  RTCPointQueryContext context;
  rtcInitPointQueryContext(&context);
  rtcPointQuery(scene, &query, &context, consider, state);
}

/// The best so far, and what it takes to compare: exact distances to the double-precision mesh.
struct Nearest {
  const TriangleMesh& mesh;
  Vector3d point;
  double slack;
  double distance2;
  ClosestPoint best;

  /// Equal distances go to the lower index, whatever order the tree is walked in.
  bool consider(std::uint32_t triangle) {
    const auto& [a, b, c] = mesh.triangles[triangle];
    const auto& v = mesh.vertices;
    const Vector3d candidate = closest_point_on_triangle(point, v[a], v[b], v[c]);
    const double candidate2 = (candidate - point).squaredNorm();
    const bool is_nearer =
        candidate2 < distance2 || (candidate2 == distance2 && triangle < best.triangle);
    if (!is_nearer) return false;
    distance2 = candidate2;
    best.point = candidate;
    best.triangle = triangle;
    return true;
  }
  double distance() const { return std::sqrt(distance2); }
};

bool consider_triangle(RTCPointQueryFunctionArguments* args) {
  auto& nearest = *static_cast<Nearest*>(args->userPtr);
  if (!nearest.consider(args->primID)) return false;
  args->query->radius = search_radius(nearest.distance(), nearest.slack);
  return true;
}

struct Within {
  const TriangleMesh& mesh;
  Vector3d centre;
  double radius;
  std::size_t limit;
  std::vector<NearTriangle>& found;
};

bool collect_triangle(RTCPointQueryFunctionArguments* args) {
  auto& within = *static_cast<Within*>(args->userPtr);
  if (within.found.size() > within.limit) return false;
  const auto& [a, b, c] = within.mesh.triangles[args->primID];
  const auto& v = within.mesh.vertices;
  const Vector3d nearest = closest_point_on_triangle(within.centre, v[a], v[b], v[c]);
  const double distance = (nearest - within.centre).norm();
  if (distance > within.radius) return false;
  within.found.push_back({distance, args->primID});
  if (within.found.size() <= within.limit) return false;
  args->query->radius = 0.0F;  // too many: the rest of the tree does not matter
  return true;
}

}  // namespace

ClosestPoint World::Impl::nearest(const Vector3d& point, double max_distance,
                                  std::uint32_t guess) const {
  if (!point.allFinite()) return {};
  const Vector3d centred = point - centre;
  const double slack = slack_at(centred);
  Nearest nearest{mesh, point, slack, max_distance * max_distance, {}};
  if (guess != Hit::kNone) nearest.consider(guess);
  const double reach = std::min(max_distance, nearest.distance());
  walk(scene.get(), point_query(centred, reach, slack), consider_triangle, &nearest);
  if (nearest.best.valid()) nearest.best.distance = nearest.distance();
  return nearest.best;
}

bool World::Impl::within(const Vector3d& around, double radius, std::size_t limit,
                         std::vector<NearTriangle>& found) const {
  const Vector3d centred = around - centre;
  found.clear();
  Within within{mesh, around, radius, limit, found};
  walk(scene.get(), point_query(centred, radius, slack_at(centred)), collect_triangle, &within);
  return found.size() <= limit;
}

ClosestPoint World::closest_point(const Vector3d& point, double max_distance) const {
  return impl_->nearest(point, max_distance, Hit::kNone);
}

void World::closest_points(std::span<const Vector3d> points, double max_distance,
                           std::span<ClosestPoint> out, const Parallel& parallel) const {
  constexpr std::size_t kBlock = 2048;  // points; a block begins without a first guess
  constexpr double kEdgesAcross = 2.0;  // widest group, see group_search.hpp
  const double group_size = kEdgesAcross * impl_->typical_edge;
  parallel.for_blocks(points.size(), kBlock, [&](std::size_t begin, std::size_t end) {
    GroupSearch(impl_->mesh, *impl_, group_size, max_distance)
        .run(points.subspan(begin, end - begin), out.subspan(begin, end - begin));
  });
}

}  // namespace lidarena
