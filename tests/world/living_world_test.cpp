// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/world/living_world.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "lidarena/base/error.hpp"
#include "tests/world/shapes.hpp"

namespace lidarena::world {
namespace {

using Eigen::Vector3d;

World hall() {
  return World(testing::box_mesh({-20, -20, 0}, {20, 20, 5}), "hall", RayCaster::kBvh);
}

MoverConfig walker() {
  MoverConfig mover;
  mover.name = "walker";
  mover.path = {{0, 0, 0}, {6, 0, 0}, {6, 3, 0}};
  mover.speed = 1.5;
  return mover;
}

TEST(Mover, WalksForthAndBackAtItsSpeedFacingAlongItsWay) {
  const MoverConfig mover = walker();
  const auto at = [&](double s) { return mover_pose(mover, from_seconds(s)); };
  EXPECT_LT((at(2).translation() - Vector3d(3, 0, 0)).norm(), 1e-9);
  EXPECT_LT((at(5).translation() - Vector3d(6, 1.5, 0)).norm(), 1e-9);
  EXPECT_LT((at(5).linear() * Vector3d::UnitX() - Vector3d::UnitY()).norm(), 1e-9);
  EXPECT_LT((at(7).translation() - Vector3d(6, 1.5, 0)).norm(), 1e-9);
  EXPECT_LT((at(7).linear() * Vector3d::UnitX() + Vector3d::UnitY()).norm(), 1e-9);
  EXPECT_LT((at(12 + 2).translation() - at(2).translation()).norm(), 1e-9);
}

TEST(Mover, GoesRoundOnAPathThatEndsWhereItBegins) {
  MoverConfig mover = walker();
  mover.path = {{0, 0, 0}, {2, 0, 0}, {2, 2, 0}, {0, 2, 0}, {0, 0, 0}};
  mover.speed = 1.0;
  mover.start_s = 100.0;  // 12 rounds and a half
  EXPECT_LT((mover_pose(mover, from_seconds(0)).translation() - Vector3d(2, 2, 0)).norm(), 1e-9);
  EXPECT_LT((mover_pose(mover, from_seconds(3)).translation() - Vector3d(0, 1, 0)).norm(), 1e-9);
}

TEST(Mover, ADoorSwingsFromClosedToItsOpeningAndBack) {
  MoverConfig door;
  door.kind = MoverKind::kDoor;
  door.path = {{1, 1, 0}, {2, 1, 0}};
  door.opening_deg = 90;
  door.period_s = 4;
  const auto leaf = [&](double s) -> Vector3d {
    return mover_pose(door, from_seconds(s)).linear() * Vector3d::UnitX();
  };
  EXPECT_LT((leaf(0) - Vector3d::UnitX()).norm(), 1e-9);
  EXPECT_LT((leaf(2) - Vector3d::UnitY()).norm(), 1e-9);
  EXPECT_LT((leaf(1) - Vector3d(1, 1, 0).normalized()).norm(), 1e-9);
  EXPECT_LT((leaf(4) - Vector3d::UnitX()).norm(), 1e-9);
}

TEST(LivingWorld, ABoxIsHitWhereItIsAtThatTimeAndTheHallElsewhere) {
  const World still = hall();
  MoverConfig box;
  box.kind = MoverKind::kBox;
  box.size = {1, 1, 1};
  box.path = {{5, -10, 0}, {5, 10, 0}};
  box.speed = 2.0;
  const LivingWorld world(still, {box});
  EXPECT_TRUE(world.moves());
  const Ray ray{{0, 0, 0.5}, {1, 0, 0}};
  const auto cast = [&](double s) {
    Hit hit;
    world.cast_at(from_seconds(s), {&ray, 1}, 100, {&hit, 1});
    return hit;
  };
  const auto mover = static_cast<std::uint32_t>(still.mesh().triangles.size());
  EXPECT_NEAR(cast(5).range, 4.5F, 1e-5F);
  EXPECT_EQ(cast(5).triangle, mover);
  EXPECT_LT((cast(5).normal - Eigen::Vector3f(-1, 0, 0)).norm(), 1e-6F);
  EXPECT_EQ(world.material(mover).name, "wood");
  EXPECT_NEAR(cast(4.7).range, 20.0F, 1e-5F);  // 0.6 m before the ray
  EXPECT_LT(cast(4.7).triangle, mover);
  EXPECT_NEAR(cast(4.8).range, 4.5F, 1e-5F);  // 0.4 m
}

TEST(LivingWorld, APersonHasHeadTrunkAndLegsOfItsHeight) {
  const World still = hall();
  MoverConfig person = walker();
  person.path = {{5, 0, 0}};
  person.height_m = 1.8;
  const LivingWorld world(still, {person});
  const auto range = [&](double y, double z) {
    const Ray ray{{0, y, z}, {1, 0, 0}};
    Hit hit;
    world.cast({&ray, 1}, 100, {&hit, 1});
    return static_cast<double>(hit.range);
  };
  EXPECT_NEAR(range(0, 1.79), 5.0, 0.05);  // the top of the head
  EXPECT_NEAR(range(0, 1.81), 20.0, 1e-5);
  EXPECT_NEAR(range(0, 0.65 * 1.8), 5.0 - 0.075 * 1.8, 2e-3);
  EXPECT_NEAR(range(0.055 * 1.8, 0.2), 5.0 - 0.045 * 1.8, 2e-3);
  EXPECT_NEAR(range(0, 0.2), 20.0, 1e-5);  // between the legs
}

TEST(LivingWorld, AgreesWithAMeshOfTheSameAtAnyTime) {
  const World still = hall();
  MoverConfig box;
  box.kind = MoverKind::kBox;
  box.size = {2, 1, 1.5};
  box.path = {{-5, -5, 0}, {5, 5, 0}, {5, -5, 0}};
  const LivingWorld world(still, {box});
  SequentialRandom random(3);
  for (const double s : {0.0, 3.3, 11.0}) {
    TriangleMesh mesh = still.mesh();
    mesh.append(testing::box_mesh({-1, -0.5, 0}, {1, 0.5, 1.5}), mover_pose(box, from_seconds(s)));
    const World whole(mesh, "whole", RayCaster::kBvh);
    std::vector<Ray> rays;
    for (int i = 0; i < 2000; ++i)
      rays.push_back({{0.5, -2.5, 2.0}, testing::random_direction(random).cast<float>()});
    std::vector<Hit> a(rays.size()), b(rays.size());
    world.cast_at(from_seconds(s), rays, 100, a);
    whole.cast(rays, 100, b);
    for (std::size_t i = 0; i < rays.size(); ++i) EXPECT_NEAR(a[i].range, b[i].range, 1e-4F);
  }
}

TEST(LivingWorld, RefusesAPathThatIsNone) {
  MoverConfig mover = walker();
  mover.path.clear();
  EXPECT_THROW(check_mover(mover, "here"), InputError);
  mover.path = {{1, 1, 0}, {1, 1, 0}};
  EXPECT_THROW(check_mover(mover, "here"), InputError);
  mover.kind = MoverKind::kDoor;
  mover.path = {{1, 1, 0}};
  EXPECT_THROW(check_mover(mover, "here"), InputError);
}

}  // namespace
}  // namespace lidarena::world
