// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/flight/coverage.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/flight/tour_scenes.hpp"

namespace lidarena::flight {
namespace {

using Eigen::Vector3d;

double share(const Seen& seen) {
  return static_cast<double>(count_seen(seen)) / static_cast<double>(seen.size());
}

TEST(Coverage, SamplesAreSpreadByArea) {
  const world::TriangleMesh mesh = test_scenes::box({0, 0, 0}, {1, 2, 10});
  const auto samples = sample_surface(mesh, 6400);  // 64 m^2: one per square decimeter
  std::vector<int> count(mesh.triangles.size(), 0);
  Vector3d mean = Vector3d::Zero();
  for (const SurfaceSample& s : samples) {
    ++count[s.triangle];
    mean += s.point / 6400.0;
    const auto& [a, b, c] = mesh.triangles[s.triangle];
    const Vector3d on = world::closest_point_on_triangle(s.point, mesh.vertices[a],
                                                         mesh.vertices[b], mesh.vertices[c]);
    ASSERT_NEAR((on - s.point).norm(), 0.0, 1e-12);
  }
  for (std::size_t i = 0; i < count.size(); ++i) {
    EXPECT_NEAR(count[i], 100.0 * 0.5 * mesh.cross(i).norm(), 1.0 + 1e-9);  // one from each share
  }
  EXPECT_NEAR((mean - Vector3d(0.5, 1, 5)).norm(), 0.0, 4.0 * 3.0 / std::sqrt(6400.0));
}

TEST(Coverage, FromInsideABoxAllIsSeenAndFromOutsideTheFacesTurnedThere) {
  const world::World world(test_scenes::box({0, 0, 0}, {2, 2, 2}));
  const auto samples = sample_surface(world.mesh(), 1200);
  EXPECT_EQ(share(seen_from(world, {0.7, 1.1, 1.6}, samples, 10)), 1.0);
  EXPECT_NEAR(share(seen_from(world, {1, 1, 5}, samples, 10)), 1.0 / 6.0, 0.005);
  EXPECT_NEAR(share(seen_from(world, {5, 6, 7}, samples, 20)), 0.5, 0.005);
}

TEST(Coverage, BeyondTheRangeNothingIsSeen) {
  const world::World world(test_scenes::box({0, 0, 0}, {2, 2, 2}));
  const auto samples = sample_surface(world.mesh(), 6000);
  // from the center, each face is seen within a circle of radius sqrt(1.2^2 - 1)
  const double expected = std::acos(-1.0) * (1.44 - 1.0) / 4.0;
  EXPECT_NEAR(share(seen_from(world, {1, 1, 1}, samples, 1.2)), expected, 0.02);
  EXPECT_EQ(count_seen(seen_from(world, {1, 1, 1}, samples, 0.99)), 0U);
}

TEST(Coverage, EveryInnerFaceOfTwoRoomsIsSeenFromBothAndNothingElse) {
  const world::World world(test_scenes::two_rooms());
  const auto samples = sample_surface(world.mesh(), 8000);
  const std::vector<Vector3d> places{{1, 1, 1}, {3, 3.5, 2}, {7, 1, 1}, {5, 3.5, 2}, {4.05, 1, 1}};
  Seen seen(samples.size(), 0);
  for (const Seen& view : seen_from_each(world, places, samples, 20, Parallel(2))) {
    add_seen(seen, view);
  }
  const double inner = test_scenes::two_rooms_inner_area() / world.mesh().area();
  // 8000 stratified samples; those up to 2 mm behind 84 m of edges may also count as seen
  EXPECT_NEAR(share(seen), inner, 0.005);
}

TEST(Coverage, ViewsAreChosenGreedilyUntilTheShareIsReached) {
  const std::vector<Seen> views{{1, 1, 0, 0, 0, 0}, {0, 1, 1, 1, 0, 0}, {0, 0, 0, 1, 1, 0}};
  // five of six samples are visible; view 1 sees three, then views 0 and 2 add one each
  EXPECT_EQ(choose_views(views, 0.6), (std::vector<std::size_t>{1}));
  EXPECT_EQ(choose_views(views, 0.8), (std::vector<std::size_t>{1, 0}));
  EXPECT_EQ(choose_views(views, 1.0), (std::vector<std::size_t>{1, 0, 2}));
}

}  // namespace
}  // namespace lidarena::flight
