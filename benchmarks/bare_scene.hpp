// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#if LIDARENA_EMBREE_MAJOR >= 4
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif
#include <tbb/task_arena.h>

#include <algorithm>
#include <cstdint>

#include "lidarena/world/triangle_mesh.hpp"

namespace lidarena {

/// The mesh in Embree directly, with the flags that World uses; counts Embree's memory in bytes.
struct BareScene {
  RTCDevice device = rtcNewDevice(nullptr);
  RTCScene scene = nullptr;
  std::int64_t bytes = 0;

  explicit BareScene(const world::TriangleMesh& mesh) {
    rtcSetDeviceMemoryMonitorFunction(
        device,
        [](void* self, ssize_t change, bool) {
          static_cast<BareScene*>(self)->bytes += change;
          return true;
        },
        this);
    RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* vertices = static_cast<float*>(
        rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                3 * sizeof(float), mesh.vertices.size()));
    for (const Eigen::Vector3d& v : mesh.vertices) {
      for (int axis = 0; axis < 3; ++axis) *vertices++ = static_cast<float>(v[axis]);
    }
    auto* indices = static_cast<std::uint32_t*>(
        rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                sizeof(world::Triangle), mesh.triangles.size()));
    for (const world::Triangle& t : mesh.triangles)
      indices = std::copy(t.begin(), t.end(), indices);
    rtcCommitGeometry(geometry);
    scene = rtcNewScene(device);
    rtcAttachGeometry(scene, geometry);
    rtcReleaseGeometry(geometry);
    rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST);
    tbb::task_arena(1).execute([&] { rtcJoinCommitScene(scene); });
  }

  void intersect(RTCRayHit8& packet) const {
    alignas(32) static constexpr int kAll[8]{-1, -1, -1, -1, -1, -1, -1, -1};
#if LIDARENA_EMBREE_MAJOR >= 4
    RTCIntersectArguments arguments;
    rtcInitIntersectArguments(&arguments);
    arguments.flags = RTC_RAY_QUERY_FLAG_COHERENT;
    rtcIntersect8(kAll, scene, &packet, &arguments);
#else
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    rtcIntersect8(kAll, scene, &context, &packet);
#endif
  }
};

}  // namespace lidarena
