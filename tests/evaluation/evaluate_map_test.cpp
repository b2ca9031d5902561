// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/evaluation/map/evaluate_map.hpp"
#include "tests/listed_sources.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include "tests/evaluation/two_threads.hpp"

#include <cmath>
#include <deque>
#include <limits>

#include "flights.hpp"
#include "lidarena/base/config_json.hpp"
#include "lidarena/evaluation/map/map_error.hpp"
#include "meshes.hpp"

namespace lidarena::evaluation {
namespace {

using namespace std::chrono_literals;
using Eigen::Vector3d;
using Eigen::Vector3f;
using listed::Truths;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

const Vector3d kHalf(1.6, 1.2, 0.8);

/// Hits on all walls of the room except within 5 cm of the corners, from inside.
ScanTruth hits_of_room(std::size_t count) {
  SequentialRandom random(91);
  ScanTruth scan{"front", Time(0), {}};
  for (std::size_t i = 0; i < count; ++i) {
    const auto axis = static_cast<Eigen::Index>(i % 3);
    const double side = random.uniform() < 0.5 ? -1.0 : 1.0;
    Vector3d at;
    for (Eigen::Index k = 0; k < 3; ++k) {
      at[k] = random.uniform(0.05 - kHalf[k], kHalf[k] - 0.05);
    }
    at[axis] = side * kHalf[axis];
    Vector3f inward = Vector3f::Zero();
    inward[axis] = static_cast<float>(-side);
    scan.points.push_back({at.cast<float>(), 1.0F, inward, 0});
  }
  return scan;
}

struct Room {
  world::World world{meshes::box(kHalf)};
  Trajectory truth = flights::sample(flights::tour, 10ms, 20s);
  ScanTruth hits = hits_of_room(60000);
  MapReference seen{
      world,
      [this] {
        Truths truths;
        truths.scans.push_back(hits);
        return make_seen_surface({observe(truths, world, kTwoThreads), {}}, world, kTwoThreads);
      }(),
      true};
  MapReference unseen{world};

  /// The hits, each `before` meters in front of the wall, in a frame that differs by `offset`.
  std::vector<Vector3f> map(double before, const Pose& offset = Pose::Identity()) const {
    std::vector<Vector3f> points;
    for (const PointTruth& hit : hits.points) {
      const Vector3d at = (hit.position + static_cast<float>(before) * hit.normal).cast<double>();
      points.push_back((offset * at).cast<float>());
    }
    return points;
  }
};

TEST(EvaluateMap, HasAllMeasuresInThreeAlignments) {
  const Room room;
  const Json m =
      to_json(evaluate_map(room.map(0.03), room.truth, room.truth, room.seen, kTwoThreads));
  for (const char* alignment : {"first_pose", "se3", "robust"}) {
    const Json& g = m[alignment];
    EXPECT_NEAR(g["distance"]["rmse_m"], 0.03, 1e-3) << alignment;
    EXPECT_NEAR(g["per_voxel"]["distance"]["rmse_m"], 0.03, 1e-3);
    EXPECT_EQ(g["cdf_percent"].size(), 20U);
    EXPECT_LT(g["cdf_percent"][1], 5.0);
    EXPECT_EQ(g["cdf_percent"][19], 100.0);
    EXPECT_EQ(g["ghosting"]["double_patches"], 0);
  }
  EXPECT_NEAR(m["se3"]["signed"]["median_m"], 0.03, 1e-3);  // in free space: in front of the wall
  EXPECT_LT(m["se3"]["signed"]["behind_percent"], 0.1);
  const Json& rows = m["se3"]["completeness"]["rows"];  // 3 cm lie between the limits of 2 and 5 cm
  ASSERT_EQ(rows.size(), 4U);
  EXPECT_LT(rows[0]["precision_percent"], 5.0);
  EXPECT_GT(rows[1]["precision_percent"], 99.5);
  EXPECT_LT(rows[0]["recall_percent"], 5.0);
  EXPECT_GT(rows[1]["recall_percent"], 99.5);
  EXPECT_GT(rows[1]["f_score_percent"], 99.5);
  for (const char* other : {"first_pose", "robust"})
    EXPECT_TRUE(m[other]["completeness"].is_null()) << other << ": of the shown alignment alone";
  // rectangular lattices with diagonals between 4.93 and 5 cm add diagonal^2 / 12 to the mean
  // square
  const Json& vertices = m["se3"]["point_vertex"];
  EXPECT_EQ(vertices["edge_m"], 0.05);
  EXPECT_GT(vertices["rmse_m"], std::hypot(0.03, 0.049 / std::sqrt(12.0)));
  EXPECT_LT(vertices["rmse_m"], std::hypot(0.03, 0.05 / std::sqrt(12.0)));
  EXPECT_TRUE(m["robust"]["point_vertex"].is_null());
  const Json without =
      to_json(evaluate_map(room.map(0.03), room.truth, room.truth, room.unseen, kTwoThreads));
  EXPECT_TRUE(without["se3"]["point_vertex"].is_null()) << "on request alone";
  EXPECT_THAT(m["robust"]["alignment"]["frozen"], IsEmpty());
  EXPECT_EQ(m["robust"]["alignment"]["starts_agreeing"], 5);
}

TEST(EvaluateMap, TheRobustAlignmentTakesTheRigidPartOfTheErrorAway) {
  const Room room;
  // the trajectory is correct, the map is 20 cm and 1 degree off
  const Pose offset = make_pose(so3::exp({0, 0, 0.0175}), Vector3d(0.15, -0.1, 0.08));
  const Json m = to_json(
      evaluate_map(room.map(0.0, offset), room.truth, room.truth, room.unseen, kTwoThreads));
  EXPECT_GT(m["se3"]["distance"]["rmse_m"], 0.05);
  EXPECT_LT(m["robust"]["distance"]["rmse_m"], 0.001);
  EXPECT_NEAR(m["robust"]["alignment"]["turned_from_first_pose_rad"], 0.0175, 1e-4);
  EXPECT_TRUE(m["se3"]["signed"].is_null());  // no ground truth of the rays
  EXPECT_TRUE(m["se3"]["completeness"].is_null());
}

TEST(EvaluateMap, TellsTheDistancesThatItScored) {
  const Room room;
  std::vector<Vector3f> map = room.map(0.03, flights::level({0.1, 0, 0}));
  map[7].x() = std::numeric_limits<float>::quiet_NaN();
  ScoredPoints scored;
  evaluate_map(map, room.truth, room.truth, room.unseen, kTwoThreads, nullptr, &scored);
  ASSERT_EQ(scored.stride, 1U);
  ASSERT_EQ(scored.distances.size(), map.size());
  EXPECT_TRUE(std::isnan(scored.distances[7]));
  std::vector<float> direct;  // of a part, which is searched in another order
  const std::vector<Vector3f> part(map.begin(), map.begin() + 1000);
  map_error(part, scored.mesh_from_map, room.world, kTwoThreads, &direct);
  direct[7] = scored.distances[7] = 0.0F;
  for (std::size_t i = 0; i < part.size(); ++i) EXPECT_EQ(scored.distances[i], direct[i]);
}

/// The class of the i-th point of a mixed map, and how far behind its wall it is, where the nearest
/// point of the room is its foot on the wall.
struct Kind {
  std::uint32_t triangle;
  double behind_m;
};
Kind kind_of(std::size_t i, const Room& room) {
  const auto triangles = static_cast<std::uint32_t>(room.world.mesh().triangles.size());
  const std::size_t k = i % 100;
  if (k < 70) return {0, 0.03};
  if (k < 90) return {triangles + 1, 0.5};
  return k < 97 ? Kind{kAir, 0.1} : Kind{kGhost, 1.0};
}

TEST(EvaluateMap, ScoresAllPointsAndTheShareOfEachClassBeside) {
  const Room room;
  dataset::Cloud map;
  Truths truths;
  truths.scans = {room.hits};
  for (std::size_t i = 0; i < room.hits.points.size(); ++i) {
    PointTruth& hit = truths.scans[0].points[i];
    const Kind kind = kind_of(i, room);
    hit.triangle = kind.triangle;
    map.points.push_back(hit.position - static_cast<float>(kind.behind_m) * hit.normal);
    map.origins.push_back({0, static_cast<std::uint32_t>(i), 0.0});
  }
  for (std::size_t i = 0; i < 600; ++i) {  // of a scan whose truth is missing
    map.points.push_back(map.points[100 * i]);
    map.origins.push_back({1, static_cast<std::uint32_t>(i), 0.0});
  }
  const IdentifiedMap identified = identify(map, truths, room.world.mesh().triangles.size());
  const results::MapMetrics metrics =
      evaluate_map(map.points, room.truth, room.truth, room.seen, kTwoThreads, &identified);
  const results::PointClasses& classes = metrics.se3.classes;
  EXPECT_EQ(metrics.se3.points, 60600U);
  EXPECT_EQ(classes.points, 60000U);
  const auto expect = [](const results::ClassOfPoints& of, double percent, double off_m) {
    EXPECT_DOUBLE_EQ(of.share_percent, percent);
    EXPECT_NEAR(*of.rmse_m, off_m, 1e-6);
    EXPECT_EQ(*of.outliers_percent, off_m > 0.2 ? 100.0 : 0.0);
  };
  expect(*classes.world, 70.0, 0.03);
  expect(*classes.mover, 20.0, 0.5);
  expect(*classes.air, 7.0, 0.1);
  expect(*classes.ghost, 3.0, 1.0);
  // the points without a class are of the world
  const double squares = 42600 * 0.0009 + 12000 * 0.25 + 4200 * 0.01 + 1800 * 1.0;
  EXPECT_NEAR(metrics.se3.distance_m.rmse, std::sqrt(squares / 60600), 1e-6);
  EXPECT_TRUE(to_json(metrics.first_pose)["classes"].is_null()) << "of the shown alignment alone";
}

TEST(EvaluateMap, NaNAndEmptyMapsGiveReasonsNotNumbers) {
  const Room room;
  const float nan = std::numeric_limits<float>::quiet_NaN();
  for (const std::vector<Vector3f>& map :
       {std::vector<Vector3f>{}, std::vector<Vector3f>(5, Vector3f(nan, 0, 0))}) {
    const Json m = to_json(evaluate_map(map, room.truth, room.truth, room.seen, kTwoThreads));
    EXPECT_EQ(m["se3"]["points"], 0);
    EXPECT_EQ(m["se3"]["invalid_points"], map.size());
    EXPECT_TRUE(m["se3"]["distance"].is_null());
    EXPECT_TRUE(m["se3"]["per_voxel"].is_null());
    EXPECT_TRUE(m["se3"]["signed"].is_null());
    EXPECT_TRUE(m["se3"]["ghosting"].is_null());
    EXPECT_THAT(m["robust"]["refused"].get<std::string>(), HasSubstr("only 0 voxels"));
  }
}

TEST(EvaluateMap, IsTheSameTextOnAnyNumberOfThreads) {
  const Room room;
  const std::vector<Vector3f> map = room.map(0.01, flights::level({0.1, 0, 0}));
  const Json one = to_json(evaluate_map(map, room.truth, room.truth, room.seen, Parallel(1)));
  const Json four = to_json(evaluate_map(map, room.truth, room.truth, room.seen, Parallel(4)));
  EXPECT_EQ(one.dump(), four.dump());
}

TEST(MapWarnings, AMeshOrAMapInMillimetersIsSuspected) {
  world::TriangleMesh millimeters = meshes::box(1000.0 * kHalf);
  const Room room;
  EXPECT_THAT(map_warnings(room.map(0.0), world::World(millimeters)),
              ElementsAre(HasSubstr("times as large as the map: is it in millimeters?")));
  std::vector<Vector3f> map = room.map(0.0);
  EXPECT_THAT(map_warnings(map, room.world), IsEmpty());
  for (Vector3f& p : map) p *= 1000.0F;
  EXPECT_THAT(map_warnings(map, room.world),
              ElementsAre(HasSubstr("times as large as the mesh: is it in millimeters?")));
}

TEST(MapWarnings, CoordinatesTooLargeForSinglePrecisionAndPointsThatAreNotFiniteAreSaid) {
  const Room room;
  std::vector<Vector3f> map = room.map(0.0);
  for (Vector3f& p : map) p += Vector3f(4.0e5F, 0, 0);
  map[0].z() = std::numeric_limits<float>::infinity();
  EXPECT_THAT(map_warnings(map, room.world),
              ElementsAre(HasSubstr("1 of 60000 points are not finite"),
                          HasSubstr("400 km from its origin")));
  EXPECT_THAT(map_warnings({}, room.world), IsEmpty());
}

}  // namespace
}  // namespace lidarena::evaluation
