// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>

#include <string>

#include "lidarena/world/world.hpp"

namespace lidarena::world::testing {

/// Base of the World tests, which run for every ray caster of this build.
class EveryRayCaster : public ::testing::TestWithParam<RayCaster> {
 protected:
  static World make_world(TriangleMesh mesh) { return World(std::move(mesh), "mesh", GetParam()); }
};

inline auto every_ray_caster() { return ::testing::ValuesIn(ray_casters()); }

inline std::string ray_caster_name(const ::testing::TestParamInfo<RayCaster>& info) {
  return info.param == RayCaster::kEmbree ? "embree" : "bvh";
}

}  // namespace lidarena::world::testing
