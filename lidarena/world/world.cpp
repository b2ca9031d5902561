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
  void occlude(RTCRay& ray) { rtcOccluded1(scene, &ray); }
};
#else
struct Caster {
  RTCScene scene;
  RTCIntersectContext context;
  explicit Caster(RTCScene s) : scene(s) { rtcInitIntersectContext(&context); }
  void intersect(RTCRayHit& ray) { rtcIntersect1(scene, &context, &ray); }
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

struct World::Impl {
  TriangleMesh mesh;
  Vector3d centre;
  std::vector<Vector3f> normals;  ///< unit, one a triangle
  double half_extent;             ///< largest coordinate of the re-centred mesh
  Device device;
  Scene scene;
};

World::World(TriangleMesh mesh, const std::string& name) : impl_(std::make_unique<Impl>()) {
  clean_mesh(mesh, name);
  const Eigen::AlignedBox3d box = mesh.bounds();
  impl_->centre = box.center();
  impl_->half_extent = 0.5 * box.sizes().maxCoeff();
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

void World::cast(std::span<const Ray> rays, double max_range, std::span<Hit> hits) const {
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
    const Vector3f& normal = impl_->normals[query.hit.primID];
    hits[i].range = query.ray.tfar;
    hits[i].triangle = query.hit.primID;
    hits[i].normal = normal.dot(ray.direction) > 0.0F ? Vector3f(-normal) : normal;
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

namespace {

/// The best so far, and what it takes to compare: exact distances to the double-precision mesh.
struct Nearest {
  const TriangleMesh& mesh;
  Vector3d point;
  double slack;  ///< how far the tree's float boxes may be from the truth
  double distance2;
  ClosestPoint best;
};

/// Radius that surely holds everything as near as `distance`.
float search_radius(double distance, double slack) {
  return static_cast<float>(distance * (1.0 + 4.0 * kFloatEpsilon) + slack);
}

bool consider_triangle(RTCPointQueryFunctionArguments* args) {
  auto& nearest = *static_cast<Nearest*>(args->userPtr);
  const auto& [a, b, c] = nearest.mesh.triangles[args->primID];
  const auto& v = nearest.mesh.vertices;
  const Vector3d candidate = closest_point_on_triangle(nearest.point, v[a], v[b], v[c]);
  const double distance2 = (candidate - nearest.point).squaredNorm();
  // Equal distances go to the lower index, whatever order the tree is walked in.
  if (distance2 > nearest.distance2 ||
      (distance2 == nearest.distance2 && args->primID >= nearest.best.triangle)) {
    return false;
  }
  nearest.distance2 = distance2;
  nearest.best.point = candidate;
  nearest.best.triangle = args->primID;
  args->query->radius = search_radius(std::sqrt(distance2), nearest.slack);
  return true;
}

}  // namespace

ClosestPoint World::closest_point(const Vector3d& point, double max_distance) const {
  const Vector3d centred = point - impl_->centre;
  // Rounding of the point, of the vertices, and of Embree's own arithmetic on their differences.
  const double slack =
      8.0 * kFloatEpsilon * (impl_->half_extent + centred.lpNorm<Eigen::Infinity>());
  Nearest nearest{impl_->mesh, point, slack, max_distance * max_distance, {}};
  RTCPointQuery query{};
  query.x = static_cast<float>(centred.x());
  query.y = static_cast<float>(centred.y());
  query.z = static_cast<float>(centred.z());
  query.radius = search_radius(max_distance, slack);
  RTCPointQueryContext context;
  rtcInitPointQueryContext(&context);
  rtcPointQuery(impl_->scene.get(), &query, &context, consider_triangle, &nearest);
  if (nearest.best.valid()) nearest.best.distance = std::sqrt(nearest.distance2);
  return nearest.best;
}

void World::closest_points(std::span<const Vector3d> points, double max_distance,
                           std::span<ClosestPoint> out, const Parallel& parallel) const {
  constexpr std::size_t kBlock = 256;
  parallel.for_each(points.size(), kBlock,
                    [&](std::size_t i) { out[i] = closest_point(points[i], max_distance); });
}

}  // namespace lidarena
