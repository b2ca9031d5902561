// SPDX-License-Identifier: BSD-3-Clause
// The worlds of the shared test data. Triangle counts and extents are those of its README; another
// program computed them by the same rules (DAE unit and node transforms applied, <up_axis> not, SDF
// poses and scales applied).
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <map>

#include "lidarena/scenes/load_world.hpp"
#include "tests/world/complaints.hpp"

namespace lidarena::scenes {
namespace {

using Eigen::Vector3d;
using ::testing::HasSubstr;

struct SharedWorld {
  const char* file;
  world::ShapeKind shapes;
  std::size_t mesh_triangles;       ///< of mesh files, as counted in the README
  std::size_t primitive_triangles;  ///< of the world's boxes, planes and spheres, as tessellated
  Eigen::AlignedBox3d extent;       ///< from the README; empty where it gives none
  const char* missing;              ///< a model known to be missing; empty if the world is complete
};

// Name of the test case in gtest.
void PrintTo(const SharedWorld& world, std::ostream* out) { *out << world.file; }

class SharedWorlds : public ::testing::TestWithParam<SharedWorld> {
 protected:
  void SetUp() override {
    file_ = std::filesystem::path(LIDARENA_SHARED_DATA) / "meshes" / GetParam().file;
    if (!std::filesystem::exists(file_)) {
      GTEST_SKIP() << "the shared test data is missing: " << GetParam().file << " is not tested";
    }
  }
  std::filesystem::path file_;
};

TEST_P(SharedWorlds, HaveTheTrianglesAndTheExtentsTheirReadmeStates) {
  const SharedWorld& expected = GetParam();
  world::testing::RecordingLog log;
  const bool is_whole = std::string(expected.missing).empty();
  WorldOptions options;
  options.shapes = expected.shapes;
  options.allow_missing = !is_whole;
  const world::WorldModel world = load_world(file_, options, log);
  EXPECT_EQ(world.mesh.triangles.size(), expected.mesh_triangles + expected.primitive_triangles);
  const Eigen::AlignedBox3d box = world.mesh.bounds();
  constexpr double kRounding = 0.5;  // m; the README rounds to meters
  for (int axis = 0; axis < 3 && !expected.extent.isEmpty(); ++axis) {
    EXPECT_NEAR(box.min()[axis], expected.extent.min()[axis], kRounding) << "axis " << axis;
    EXPECT_NEAR(box.max()[axis], expected.extent.max()[axis], kRounding) << "axis " << axis;
  }
  EXPECT_EQ(log.warnings.empty(), is_whole) << log.warnings;
  EXPECT_THAT(log.warnings, HasSubstr(expected.missing));
}

// 64 sectors and 32 stacks of two triangles per sector, one triangle at the poles
constexpr std::size_t kSphere = 2 * 64 * 31;
constexpr std::size_t kBox = 12, kPlane = 2;

Eigen::AlignedBox3d extent(const Vector3d& low, const Vector3d& high) { return {low, high}; }

INSTANTIATE_TEST_SUITE_P(
    All, SharedWorlds,
    ::testing::Values(
        // two balls
        SharedWorld{"aws_small_house/worlds/small_house.world", world::ShapeKind::kVisual, 145844,
                    2 * kSphere, extent({-9.5, -5.7, 0}, {9.5, 5.7, 3}), ""},
        SharedWorld{"aws_small_house/worlds/small_house.world", world::ShapeKind::kCollision, 4131,
                    2 * kSphere, extent({-9.5, -5.7, 0}, {9.5, 5.7, 3}), ""},
        SharedWorld{"darpa_cave_02/worlds/darpa_cave_02.world", world::ShapeKind::kVisual, 718583,
                    0, extent({12, -162, -41}, {235, 169, 23}), "Cave Straight 01"},
        SharedWorld{"darpa_cave_02/worlds/darpa_cave_02_filled.world",
                    world::ShapeKind::kVisual,
                    796150,
                    0,
                    {},
                    "Cave Starting Area"},
        SharedWorld{"lava_tube/worlds/lava_tube.world",
                    world::ShapeKind::kVisual,
                    8224,
                    0,
                    {},
                    "construction_cone"},
        // The README's 29,251 includes two boxes, one of which is a collision shape. The polygons
        // of the OBJ files (number of corners minus two) sum to 29,227 over the 150 instances.
        SharedWorld{"subt_cave_tiles/worlds/cave.world", world::ShapeKind::kVisual, 29227, kBox,
                    extent({-13, -53, -3}, {413, 53, 8}), "jersey_barrier"},
        // The ground plane of 100 m x 100 m is wider than the cave.
        // with the poses of its <state>: -77, not -80 m
        SharedWorld{"ltu_cave/worlds/cave_world1.world", world::ShapeKind::kVisual, 5333, kPlane,
                    extent({-77, -50, -3}, {50, 71, 30}), "cave_tile_2_1"},
        SharedWorld{"edgar_mine/worlds/edgar_mine.world", world::ShapeKind::kVisual, 22557, 0,
                    extent({-23, -27, -1}, {502, 236, 6}), ""}));

TEST(LavaTube, IsTheClosedSurfaceOfTheSizeItsReadmeStates) {
  const auto file =
      std::filesystem::path(LIDARENA_SHARED_DATA) / "meshes/lava_tube/worlds/lava_tube.world";
  if (!std::filesystem::exists(file)) {
    GTEST_SKIP() << "the shared test data is missing: the lava tube is not tested";
  }
  WorldOptions options;
  options.allow_missing = true;
  LogSink log;
  const world::TriangleMesh tube = load_world(file, options, log).mesh;
  const Vector3d sizes = tube.bounds().sizes();
  EXPECT_NEAR(sizes.x(), 43, 0.5);
  EXPECT_NEAR(sizes.y(), 102, 0.5);
  EXPECT_NEAR(sizes.z(), 14, 0.5);
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
  for (const world::Triangle& t : tube.triangles) {
    for (std::size_t i = 0; i < 3; ++i) {
      const auto [a, b] = std::minmax({t[i], t[(i + 1) % 3]});
      ++edges[{a, b}];
    }
  }
  EXPECT_EQ(std::ranges::count_if(edges, [](const auto& edge) { return edge.second == 1; }), 0);
}

TEST(LavaTube, IsRefusedWithTheRemedyBecauseModelsAreMissing) {
  const auto file =
      std::filesystem::path(LIDARENA_SHARED_DATA) / "meshes/lava_tube/worlds/lava_tube.world";
  if (!std::filesystem::exists(file)) {
    GTEST_SKIP() << "the shared test data is missing: the lava tube is not tested";
  }
  LogSink log;
  const std::string error = world::testing::input_error_of([&] { load_world(file, {}, log); });
  EXPECT_THAT(error, HasSubstr("model://construction_cone (2 times), model://gate (3 times)"));
  EXPECT_THAT(error, HasSubstr(file.string()));
  EXPECT_THAT(error, HasSubstr("allow_missing"));
}

}  // namespace
}  // namespace lidarena::scenes
