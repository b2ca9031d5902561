// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/flight/free_space.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "tests/flight/tour_scenes.hpp"

namespace lidarena::flight {
namespace {

using Eigen::Vector3d;

const world::World& rooms() {
  static const world::World world(test_scenes::two_rooms());
  return world;
}

bool reaches(const FreeSpace& space, double x) {
  return std::any_of(space.cells().begin(), space.cells().end(),
                     [&](const FreeSpace::Cell& cell) { return cell.point.x() > x; });
}

TEST(FreeSpace, EveryCellKeepsTheLeastDistanceInsideTheBox) {
  const FreeSpace space(rooms(), {1, 1, 1.2}, {0.4, 0.5}, 0.1, 100'000, Parallel(2));
  ASSERT_GT(space.cells().size(), 1000U);
  for (const FreeSpace::Cell& cell : space.cells()) {
    const double distance = rooms().closest_point(cell.point).distance;
    ASSERT_GE(distance, 0.4);
    ASSERT_NEAR(std::min(distance, 1.0), cell.clearance, 1e-12);
    ASSERT_TRUE(rooms().mesh().bounds().contains(cell.point));
  }
}

TEST(FreeSpace, FillsTheRoomsShrunkByTheDistance) {
  const FreeSpace space(rooms(), {1, 1, 1.2}, {0.4, 0.4}, 0.1, 100'000, Parallel(2));
  // both rooms of 3.2 x 3.2 x 1.7 m, and the passage of the door of 0.9 x 0.1 x 1.2 m, to within
  // half a cell on each side
  const double low = 2 * 3.1 * 3.1 * 1.6;
  const double high = 2 * 3.3 * 3.3 * 1.8 + 1.0 * 0.2 * 1.3;
  const double volume = static_cast<double>(space.cells().size()) * 1e-3;
  EXPECT_GT(volume, low);
  EXPECT_LT(volume, high);
}

TEST(FreeSpace, ADoorIsPassedWhereverTheGridLies) {
  for (double shift = 0.0; shift < 0.1; shift += 0.019) {
    const Vector3d start(1 + shift, 2 - shift, 1 + 0.5 * shift);
    for (const double cell : {0.1, 0.17}) {
      EXPECT_TRUE(reaches(FreeSpace(rooms(), start, {0.41, 0.5}, cell, 100'000, Parallel(2)), 5))
          << "shift " << shift << " cell " << cell;
    }
  }
}

TEST(FreeSpace, ADoorTooNarrowForTheDistanceIsNotPassedWhateverTheCells) {
  for (const double cell : {0.05, 0.1, 0.4}) {
    const FreeSpace space(rooms(), {1, 1, 1.2}, {0.46, 0.5}, cell, 1'000'000, Parallel(2));
    EXPECT_GT(space.cells().size(), 20U);
    EXPECT_FALSE(reaches(space, 4));
  }
}

TEST(FreeSpace, TakesLargerCellsWhereThereWouldBeTooMany) {
  const FreeSpace space(rooms(), {1, 1, 1.2}, {0.4, 0.5}, 0.02, 20'000, Parallel(2));
  EXPECT_LE(space.cells().size(), 20'000U);
  EXPECT_GT(space.cells().size(), 2'000U);
  EXPECT_GT(space.voxel_size_m(), 0.02);
}

TEST(FreeSpace, IsEmptyAtAStartInAWallOrOutsideTheBox) {
  EXPECT_TRUE(
      FreeSpace(rooms(), {4.05, 3, 1}, {0.4, 0.5}, 0.1, 10'000, Parallel(1)).cells().empty());
  EXPECT_TRUE(FreeSpace(rooms(), {20, 3, 1}, {0.4, 0.5}, 0.1, 10'000, Parallel(1)).cells().empty());
}

TEST(FreeSpace, ShortestWaysAreThoseOfTheRelaxedGraph) {
  const FreeSpace space(rooms(), {1, 1, 1.2}, {0.4, 0.5}, 0.2, 100'000, Parallel(1));
  const auto cells = space.cells();
  // Bellman-Ford: relax every edge until nothing changes
  std::vector<std::int32_t> slow(cells.size(), 1'000'000);
  slow[0] = 0;
  for (bool changed = true; changed;) {
    changed = false;
    for (std::size_t i = 0; i < cells.size(); ++i) {
      for (const std::int32_t next : cells[i].next) {
        if (next == FreeSpace::kNone) continue;
        const bool wide = space.is_wide(next) && space.is_wide(static_cast<std::int32_t>(i));
        const std::int32_t there = slow[i] + (wide ? 2 : 6);
        if (there >= slow[static_cast<std::size_t>(next)]) continue;
        slow[static_cast<std::size_t>(next)] = there;
        changed = true;
      }
    }
  }
  EXPECT_EQ(space.lengths_from(0), slow);
}

TEST(FreeSpace, AWayLeadsFromNeighborToNeighborThroughTheDoor) {
  const FreeSpace space(rooms(), {1, 1, 1.2}, {0.4, 0.5}, 0.1, 100'000, Parallel(2));
  std::int32_t far = 0;
  for (std::size_t i = 0; i < space.cells().size(); ++i) {
    const double x = space.cells()[i].point.x();
    if (x > space.cells()[static_cast<std::size_t>(far)].point.x()) {
      far = static_cast<std::int32_t>(i);
    }
  }
  const auto path = space.path(0, far);
  ASSERT_EQ(path.front(), 0);
  ASSERT_EQ(path.back(), far);
  for (std::size_t i = 1; i < path.size(); ++i) {
    const auto& next = space.cells()[static_cast<std::size_t>(path[i - 1])].next;
    ASSERT_NE(std::find(next.begin(), next.end(), path[i]), next.end());
    const Vector3d a = space.cells()[static_cast<std::size_t>(path[i - 1])].point;
    const Vector3d b = space.cells()[static_cast<std::size_t>(path[i])].point;
    for (double s = 0.0; s <= 1.0; s += 0.25) {
      ASSERT_GE(rooms().closest_point(a + s * (b - a)).distance, 0.39);
    }
  }
}

TEST(FreeSpace, IsTheSameOnAnyNumberOfThreads) {
  const FreeSpace one(rooms(), {1, 1, 1.2}, {0.4, 0.5}, 0.15, 100'000, Parallel(1));
  const FreeSpace three(rooms(), {1, 1, 1.2}, {0.4, 0.5}, 0.15, 100'000, Parallel(3));
  ASSERT_EQ(one.cells().size(), three.cells().size());
  for (std::size_t i = 0; i < one.cells().size(); ++i) {
    ASSERT_EQ(one.cells()[i].point, three.cells()[i].point);
    ASSERT_EQ(one.cells()[i].next, three.cells()[i].next);
  }
}

TEST(FreeSpace, AStraightWayIsClearUpToItsNearestSurface) {
  // passes the door post at (4 .. 4.1, 0.58) at a distance of 0.3 m
  const Vector3d from(1, 0.88, 1.2), to(7, 0.88, 1.2);
  EXPECT_TRUE(is_clear(rooms(), from, to, 0.299));
  EXPECT_FALSE(is_clear(rooms(), from, to, 0.301));
  EXPECT_FALSE(is_clear(rooms(), {1, 3, 1}, {7, 3, 1}, 0.0));
  EXPECT_TRUE(is_clear(rooms(), from, from, 0.1));
}

}  // namespace
}  // namespace lidarena::flight
