// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>

#include "lidarena/dataset/part_file.hpp"
#include "lidarena/dataset/points/cloud.hpp"
#include "lidarena/report/scene_blocks.hpp"
#include "lidarena/report/scene_files.hpp"
#include "tests/temporary_folder.hpp"

namespace lidarena::report {
namespace {

using ::testing::SizeIs;

/// Points on a 1 cm lattice, scattered over 20 x 20 x 2 m by a multiplier that is coprime to the
/// modulus; each point's distance is its index.
SceneCloud lattice_cloud(std::size_t count) {
  SceneCloud cloud;
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t k = (i * 7919) % 800'000'000;
    cloud.points.emplace_back(0.01F * static_cast<float>(k % 2000),
                              0.01F * static_cast<float>(k / 2000 % 2000),
                              0.01F * static_cast<float>(k % 201));
    cloud.distance.push_back(static_cast<float>(i));
  }
  return cloud;
}

struct Unpacked {
  Eigen::Vector3d point;
  std::optional<double> value;  ///< of the only field
  double half_step = 0.0;       ///< of the coordinates, m
};

/// The first `parts` blocks of a cloud with one field, read as viewer/src/view/cloud.ts reads them.
std::vector<Unpacked> unpacked(const PackedScene& scene, std::size_t parts) {
  const Json& cloud = scene.header.at("clouds").at(0);
  const Json& field = cloud.at("fields").at(0);
  const std::size_t all_parts = cloud.at("blocks").size();
  std::vector<Unpacked> points;
  for (std::size_t part = 0; part < parts; ++part) {
    const std::string& bytes = scene.blocks.at(cloud.at("blocks").at(part).get<std::size_t>());
    std::size_t offset = 0;
    const auto next = [&] {
      std::uint16_t value = 0;
      std::memcpy(&value, bytes.data() + offset, sizeof(value));
      offset += sizeof(value);
      return static_cast<double>(value);
    };
    for (const Json& chunk : cloud.at("chunks")) {
      const auto count = chunk.at("count").get<std::size_t>();
      const std::size_t n = count * (part + 1) / all_parts - count * part / all_parts;
      const std::size_t first = points.size();
      for (std::size_t i = 0; i < n; ++i) {
        Unpacked u;
        for (std::size_t axis = 0; axis < 3; ++axis) {
          const double size = chunk.at("size").at(axis).get<double>();
          u.point[static_cast<Eigen::Index>(axis)] =
              chunk.at("min").at(axis).get<double>() + size * next() / 65535.0;
          u.half_step = std::max(u.half_step, 0.5 * size / 65535.0);
        }
        points.push_back(u);
      }
      for (std::size_t i = 0; i < n; ++i) {
        const double stored = next();
        const double low = field.at("min").get<double>();
        const double span = field.at("max").get<double>() - low;
        if (stored < 65535.0) points[first + i].value = low + span * stored / 65534.0;
      }
    }
    EXPECT_EQ(offset, bytes.size());
  }
  return points;
}

TEST(SceneBlocks, EveryPointComesBackWithinHalfAStep) {
  constexpr std::size_t kCount = 60'000;  // fewer than 65,534, so that distances come back exactly
  Scene scene;
  scene.clouds.push_back(lattice_cloud(kCount));
  const std::vector<Unpacked> points = unpacked(pack(scene, Parallel(2)), 1);
  ASSERT_EQ(points.size(), kCount);
  std::vector<int> seen(kCount, 0);
  for (const Unpacked& u : points) {
    ASSERT_TRUE(u.value);
    const auto i = static_cast<std::size_t>(std::lround(*u.value));
    ++seen.at(i);
    // half a step, and single precision at 20 m
    EXPECT_LE((u.point - scene.clouds[0].points[i].cast<double>()).cwiseAbs().maxCoeff(),
              u.half_step + 2e-6);
  }
  EXPECT_THAT(seen, ::testing::Each(1));
}

TEST(SceneBlocks, TheFirstBlockIsAFairSampleOfTheWholeCloud) {
  constexpr std::size_t kCount = 2'500'000;
  Scene scene;
  scene.clouds.push_back(lattice_cloud(kCount));
  const PackedScene packed = pack(scene, Parallel(2));
  const Json& cloud = packed.header.at("clouds").at(0);
  ASSERT_THAT(cloud.at("blocks"), SizeIs(2));
  for (const Json& chunk : cloud.at("chunks")) EXPECT_LE(chunk.at("count"), 65'536);
  const std::vector<Unpacked> half = unpacked(packed, 1);
  EXPECT_NEAR(static_cast<double>(half.size()), kCount / 2.0,
              static_cast<double>(cloud.at("chunks").size()));
  // Each tenth of the points' indices has a tenth of the sample: binomial, five sigmas.
  std::vector<double> tenths(10, 0.0);
  for (const Unpacked& u : half)
    tenths[static_cast<std::size_t>(*u.value / kCount * 9.999999)] += 1;
  const double expected = static_cast<double>(half.size()) / 10.0;
  for (const double n : tenths) EXPECT_NEAR(n, expected, 5.0 * std::sqrt(0.9 * expected));
}

TEST(SceneBlocks, TheSameBytesOnAnyNumberOfThreads) {
  Scene scene;
  scene.clouds.push_back(lattice_cloud(300'000));
  const PackedScene one = pack(scene, Parallel(1));
  const PackedScene three = pack(scene, Parallel(3));
  EXPECT_EQ(one.header, three.header);
  EXPECT_EQ(one.blocks, three.blocks);
}

TEST(SceneBlocks, PointsThatAreNotFiniteAreLeftOutAndMissingValuesSaidToBe) {
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  Scene scene;
  SceneCloud cloud;
  cloud.points = {{0, 0, 0}, {kNan, 0, 0}, {1, 2, 3}, {INFINITY, 0, 0}};
  cloud.distance = {0.5F, 0.1F, kNan, 9.0F};
  scene.clouds.push_back(cloud);
  const std::vector<Unpacked> points = unpacked(pack(scene, Parallel(1)), 1);
  ASSERT_THAT(points, SizeIs(2));
  const bool first_is_origin = points[0].point.norm() < 1e-6;
  EXPECT_NEAR(points[first_is_origin ? 0 : 1].value.value_or(-1), 0.5, 1e-4);
  EXPECT_FALSE(points[first_is_origin ? 1 : 0].value);
}

TEST(SceneBlocks, AnEmptySceneStillHasSomethingToLookAt) {
  const PackedScene packed = pack(Scene{}, Parallel(1));
  EXPECT_TRUE(packed.blocks.empty());
  EXPECT_TRUE(packed.header.at("time").is_null());
  EXPECT_EQ(packed.header.at("bounds"), (Json{{-0.5, -0.5, -0.5}, {0.5, 0.5, 0.5}}));
}

/// A square of 10 x 10 m in the plane z = 0.
SceneMesh floor_mesh() {
  SceneMesh floor;
  floor.name = "floor";
  floor.mesh.vertices = {{0, 0, 0}, {10, 0, 0}, {10, 10, 0}, {0, 10, 0}};
  floor.mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  return floor;
}

TEST(SceneFiles, DistancesToAPlaneAreHeights) {
  Scene scene;
  scene.meshes.push_back(floor_mesh());
  SceneCloud cloud;
  cloud.points = {{5, 5, 0.25F}, {2, 8, -1.0F}, {5, 5, 3.0F}};
  scene.clouds.push_back(cloud);
  measure_distances(scene, Parallel(1));
  EXPECT_FLOAT_EQ(scene.clouds[0].distance[0], 0.25F);
  EXPECT_FLOAT_EQ(scene.clouds[0].distance[1], 1.0F);
  EXPECT_TRUE(std::isnan(scene.clouds[0].distance[2])) << "beyond the maximum distance of 2 m";
}

TEST(SceneFiles, ACloudFarFromTheOriginKeepsItsCentimeters) {
  const TemporaryFolder folder;
  std::string rows;
  for (int i = 0; i < 10; ++i) rows += "4321000." + std::to_string(i) + "1 500000.5 12.25\n";
  dataset::write_text_file(
      folder.path() / "far.ply",
      "ply\nformat ascii 1.0\nelement vertex 10\nproperty double x\nproperty double y\n"
      "property double z\nend_header\n" +
          rows);
  Scene scene;
  add_cloud_file(scene, folder.path() / "far.ply", {});
  ASSERT_THAT(scene.clouds[0].points, SizeIs(10));
  EXPECT_DOUBLE_EQ(scene.origin.x(), 4321000.0);
  EXPECT_NEAR(scene.clouds[0].points[3].x(), 0.31, 1e-6);
}

TEST(SceneFiles, ALargeCloudIsThinnedToAboutTheLimitAndTheRestIsCounted) {
  const TemporaryFolder folder;
  dataset::Cloud cloud;
  for (int i = 0; i < 20'000; ++i) cloud.points.emplace_back(static_cast<float>(i), 0.0F, 0.0F);
  dataset::write_ply(folder.path() / "map.ply", cloud);
  Scene scene;
  SceneOptions options;
  options.max_points = 5000;
  add_cloud_file(scene, folder.path() / "map.ply", options);
  const std::size_t kept = scene.clouds[0].points.size();
  EXPECT_NEAR(static_cast<double>(kept), 5000.0, 5.0 * std::sqrt(5000.0 * 0.75));  // binomial
  EXPECT_EQ(kept + scene.clouds[0].left_out, 20'000U);
}

}  // namespace
}  // namespace lidarena::report
