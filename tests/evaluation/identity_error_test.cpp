// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/evaluation/map/identity_error.hpp"

#include <gtest/gtest.h>

#include <deque>

#include "flights.hpp"
#include "lidarena/evaluation/map/map_error.hpp"
#include "meshes.hpp"

namespace lidarena::evaluation {
namespace {

using namespace std::chrono_literals;
using Eigen::Vector3d;
using Eigen::Vector3f;

template <class Base, class Item>
class Queue : public Base {
 public:
  std::optional<Item> next() override {
    if (items.empty()) return std::nullopt;
    Item item = std::move(items.front());
    items.pop_front();
    return item;
  }
  std::deque<Item> items;
};

/// A thin wall of 4 cm whose faces are x = 5 and x = 5.04; every return is of the near face, and
/// displaced by `moved` from its true hit. The sensor stands still at the origin.
struct Wall {
  Queue<EventSource, Event> events;
  Queue<ScanTruthSource, ScanTruth> truth;
  world::World world{[] {
    world::TriangleMesh mesh;
    mesh.append(meshes::box(Vector3d(0.02, 3, 3)), flights::level({5.02, 0, 0}));
    return mesh;
  }()};

  explicit Wall(const Vector3d& moved) {
    SequentialRandom random(95);
    for (int s = 0; s < 10; ++s) {
      const Time stamp = 100ms * s;
      Scan scan{stamp, {}, true};
      ScanTruth hits{"front", stamp, {}};
      for (int i = 0; i < 200; ++i) {
        const double y = random.uniform(-2, 2);
        const Vector3d at(5.0, y, random.uniform(-2, 2));
        scan.points.push_back({(at + moved).cast<float>(), 0.0F, 1000 * i, 0, 0});
        hits.points.push_back({at.cast<float>(), 5.0F, Vector3f(-1, 0, 0), 0});
      }
      events.items.push_back({"rear", Scan{stamp, {{}}, true}});  // of another sensor: not counted
      events.items.push_back({"front", std::move(scan)});
      truth.items.push_back(std::move(hits));
    }
  }

  IdentifiedMap identified(const Trajectory& estimate) {
    const dataset::Cloud map = reprojected(events, "front", Pose::Identity(), estimate);
    EXPECT_EQ(map.origins.size(), map.points.size());
    return identify(map, truth, world.mesh().triangles.size());
  }
};

Trajectory still() {
  return flights::sample([](double) { return Pose::Identity(); }, 50ms, 2s);
}

TEST(IdentityError, IsSplitAlongTheNormalAndAlongTheSurface) {
  Wall wall(Vector3d(0.03, 0.0, 0.04));  // 3-4-5
  const IdentifiedMap map = wall.identified(still());
  EXPECT_GT(map.points.size(), 1800U);
  const IdentityError e = identity_error(map, Pose::Identity());
  EXPECT_NEAR(e.distance_m.rmse, 0.05, 1e-6);
  EXPECT_NEAR(e.normal_m.max, 0.03, 1e-6);
  EXPECT_NEAR(e.tangential_m.rmse, 0.04, 1e-6);
  EXPECT_LT(identity_error(map, flights::level({-0.03, 0.0, -0.04})).distance_m.max, 1e-6);
}

TEST(IdentityError, SeesAGhostBehindAThinWallWhichTheDistanceToTheMeshDoesNot) {
  Wall wall(Vector3d(0.05, 0.0, 0.0));
  const IdentifiedMap map = wall.identified(still());
  EXPECT_NEAR(identity_error(map, Pose::Identity()).distance_m.rmse, 0.05, 1e-6);
  const MapError near = map_error(map.points, Pose::Identity(), wall.world, Parallel(1));
  EXPECT_NEAR(near.distance_m.rmse, 0.01, 1e-5);  // to the far face
}

TEST(IdentityError, FollowsPointsThroughScansThatWereDropped) {
  Wall wall(Vector3d(0.03, 0.0, 0.04));
  // no pose before 0.35 s: the first scans give no points, and the scans after them keep their
  // numbers
  const Trajectory late = flights::with_gap(still(), -1s, 350ms);
  const IdentifiedMap map = wall.identified(late);
  EXPECT_GT(map.points.size(), 1000U);
  EXPECT_NEAR(identity_error(map, Pose::Identity()).distance_m.max, 0.05, 1e-6);
}

TEST(IdentityError, WithoutTruthThereIsNone) {
  Wall wall(Vector3d::Zero());
  wall.truth.items.clear();
  const IdentifiedMap map = wall.identified(still());
  EXPECT_TRUE(map.points.empty());
  EXPECT_EQ(identity_error(map, Pose::Identity()).distance_m.count, 0U);
}

}  // namespace
}  // namespace lidarena::evaluation
