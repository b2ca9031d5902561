// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/world/embree_tree.hpp"

// The only file that includes Embree; it supports versions 3 and 4.
#if LIDARENA_EMBREE_MAJOR >= 4
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif
#include <tbb/task_arena.h>

#include <algorithm>
#include <cmath>

#include "lidarena/base/error.hpp"

namespace lidarena::world {

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

Scene build_scene(RTCDevice device, const TriangleMesh& mesh, const Vector3d& center) {
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
      for (int axis = 0; axis < 3; ++axis) *vertices++ = static_cast<float>(v[axis] - center[axis]);
    }
    for (const Triangle& triangle : mesh.triangles) {
      indices = std::copy(triangle.begin(), triangle.end(), indices);
    }
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene.get(), geometry);
    rtcSetSceneFlags(scene.get(), RTC_SCENE_FLAG_ROBUST);  // no ray passes between two triangles
    // Built by one thread: which of two triangles is reported for a ray through their common edge
    // depends on the tree, and the tree depends on the number of threads that build it.
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

/// Eight rays in the layout of Embree's packet queries; lanes without a ray are marked invalid.
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
  void load(std::span<const Ray> rays, const Vector3d& center, float far) {
    for (std::size_t i = 0; i < kSize; ++i) {
      valid[i] = i < rays.size() ? -1 : 0;
      const Ray& ray = rays[std::min(i, rays.size() - 1)];
      query.ray.org_x[i] = static_cast<float>(ray.origin.x() - center.x());
      query.ray.org_y[i] = static_cast<float>(ray.origin.y() - center.y());
      query.ray.org_z[i] = static_cast<float>(ray.origin.z() - center.z());
      query.ray.dir_x[i] = ray.direction.x();
      query.ray.dir_y[i] = ray.direction.y();
      query.ray.dir_z[i] = ray.direction.z();
      query.ray.tfar[i] = far;
      query.hit.geomID[i] = RTC_INVALID_GEOMETRY_ID;
    }
  }
};

class EmbreeTree : public MeshTree {
 public:
  EmbreeTree(const TriangleMesh& mesh, const std::string& name) {
    const Eigen::AlignedBox3d box = mesh.bounds();
    center_ = box.center();
    half_extent_ = 0.5 * box.sizes().maxCoeff();
    device_.reset(rtcNewDevice(nullptr));
    check(device_.get(), name);
    scene_ = build_scene(device_.get(), mesh, center_);
    check(device_.get(), name);
  }

  void cast(std::span<const Ray> rays, double max_range, std::span<Hit> hits,
            RayOrder order) const override {
    const auto far = static_cast<float>(max_range);
    if (order == RayOrder::kNeighbors) return cast_packets(rays, far, hits);
    cast_one_by_one(rays, far, hits);
  }
  bool occluded(const Ray& ray, double near, double far) const override;
  void visit_near(const Vector3d& point, double radius, TriangleVisitor& visitor) const override;

 private:
  void cast_one_by_one(std::span<const Ray> rays, float far, std::span<Hit> hits) const;
  void cast_packets(std::span<const Ray> rays, float far, std::span<Hit> hits) const;

  Vector3d center_;
  double half_extent_;  ///< largest coordinate of the re-centered mesh
  Device device_;
  Scene scene_;
};

void EmbreeTree::cast_one_by_one(std::span<const Ray> rays, float far, std::span<Hit> hits) const {
  Caster caster{scene_.get()};
  RTCRayHit query{};
  for (std::size_t i = 0; i < rays.size(); ++i) {
    query.ray = make_ray(rays[i].origin - center_, rays[i].direction, 0.0F, far);
    query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    caster.intersect(query);
    const bool is_hit = query.hit.geomID != RTC_INVALID_GEOMETRY_ID;
    hits[i] = is_hit ? Hit{query.ray.tfar, query.hit.primID, Vector3f::Zero()} : Hit{};
  }
}

void EmbreeTree::cast_packets(std::span<const Ray> rays, float far, std::span<Hit> hits) const {
  Caster caster{scene_.get()};
  Packet packet;
  for (std::size_t first = 0; first < rays.size(); first += Packet::kSize) {
    const auto together = rays.subspan(first, std::min(Packet::kSize, rays.size() - first));
    packet.load(together, center_, far);
    caster.intersect(packet.valid, packet.query);
    for (std::size_t i = 0; i < together.size(); ++i) {
      const bool is_hit = packet.query.hit.geomID[i] != RTC_INVALID_GEOMETRY_ID;
      hits[first + i] =
          is_hit ? Hit{packet.query.ray.tfar[i], packet.query.hit.primID[i], Vector3f::Zero()}
                 : Hit{};
    }
  }
}

bool EmbreeTree::occluded(const Ray& ray, double near, double far) const {
  RTCRay query = make_ray(ray.origin - center_, ray.direction, static_cast<float>(near),
                          static_cast<float>(far));
  Caster{scene_.get()}.occlude(query);
  return query.tfar < 0.0F;  // Embree marks an occluded ray by -infinity
}

/// Search radius for Embree that covers all points within `distance` in spite of rounding.
/// `slack`: see visit_near.
float search_radius(double distance, double slack) {
  return static_cast<float>(distance * (1.0 + 4.0 * kFloatEpsilon) + slack);
}

struct Visit {
  TriangleVisitor& visitor;
  double slack;
};

bool visit_triangle(RTCPointQueryFunctionArguments* args) {
  const auto& [visitor, slack] = *static_cast<Visit*>(args->userPtr);
  const float radius = search_radius(visitor.visit(args->primID), slack);
  if (radius >= args->query->radius) return false;
  args->query->radius = radius;
  return true;
}

void EmbreeTree::visit_near(const Vector3d& point, double radius, TriangleVisitor& visitor) const {
  const Vector3d centered = point - center_;
  // Bound on the error of the tree's single-precision boxes: rounding of the point and of the
  // vertices, and of Embree's own arithmetic on their differences.
  const double slack = 8.0 * kFloatEpsilon * (half_extent_ + centered.lpNorm<Eigen::Infinity>());
  RTCPointQuery query{};
  query.x = static_cast<float>(centered.x());
  query.y = static_cast<float>(centered.y());
  query.z = static_cast<float>(centered.z());
  query.radius = search_radius(radius, slack);
  Visit visit{visitor, slack};
  RTCPointQueryContext context;
  rtcInitPointQueryContext(&context);
  rtcPointQuery(scene_.get(), &query, &context, visit_triangle, &visit);
}

}  // namespace

std::unique_ptr<MeshTree> make_embree_tree(const TriangleMesh& mesh, const std::string& name) {
  return std::make_unique<EmbreeTree>(mesh, name);
}

}  // namespace lidarena::world
