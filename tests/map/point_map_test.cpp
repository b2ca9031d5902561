// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/map/point_map.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <set>

#include "lidarena/base/error.hpp"
#include "lidarena/base/random.hpp"
#include "lidarena/map/voxel_filter.hpp"

namespace lidarena::map {
namespace {

using Points = std::vector<Eigen::Vector3f>;
using Cell = std::array<long, 3>;

/// Reference: the cell of a point, computed in the simplest way.
Cell cell_of(const Eigen::Vector3f& p, double size) {
  return {std::lround(std::floor(p.x() / size)), std::lround(std::floor(p.y() / size)),
          std::lround(std::floor(p.z() / size))};
}

Points random_points(std::size_t count, double reach) {
  SequentialRandom random(7);
  Points points;
  for (std::size_t i = 0; i < count; ++i) {
    points.emplace_back(static_cast<float>(random.uniform(-reach, reach)),
                        static_cast<float>(random.uniform(-reach, reach)),
                        static_cast<float>(random.uniform(-reach, reach)));
  }
  return points;
}

/// Reference: the first points of their cells, by a std::set. 0.5 m is a power of two, so float and
/// double agree on the edges of all cells.
Points first_ones(const Points& points, double size) {
  std::set<Cell> seen;
  Points kept;
  for (const auto& p : points) {
    if (seen.insert(cell_of(p, size)).second) kept.push_back(p);
  }
  return kept;
}

TEST(PointMap, KeepsTheFirstPointOfEachVoxelInTheOrderTheyCame) {
  const Points points = random_points(20000, 6.0);
  PointMap map(0.5);
  map.insert(points);
  const Points expected = first_ones(points, 0.5);
  ASSERT_GT(expected.size(), 5000U);
  ASSERT_EQ(map.size(), expected.size());
  EXPECT_TRUE(std::equal(expected.begin(), expected.end(), map.points().begin()));
}

TEST(PointMap, ABatchAddsWhatItsPointsAddOneByOneAndTellsWhich) {
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  Points points = random_points(5000, 4.0);
  for (std::size_t i = 0; i < points.size(); i += 7) points[i].x() = kNan;
  PointMap one_by_one(0.5);
  std::vector<std::uint32_t> expected;
  for (std::uint32_t i = 0; i < points.size(); ++i) {
    if (one_by_one.insert(points[i])) expected.push_back(i);
  }
  PointMap batch(0.5);
  batch.insert(points);
  OccupiedVoxels voxels(0.5);
  std::vector<std::uint32_t> added;
  voxels.insert(points, added);
  ASSERT_GT(expected.size(), 1000U);
  EXPECT_EQ(added, expected);
  EXPECT_TRUE(std::ranges::equal(batch.points(), one_by_one.points()));
}

TEST(PointMap, CellsOnBothSidesOfZeroAreDifferentOnes) {
  PointMap map(1.0);
  EXPECT_TRUE(map.insert({0.1F, 0.1F, 0.1F}));
  EXPECT_TRUE(map.insert({-0.1F, 0.1F, 0.1F}));
  EXPECT_TRUE(map.insert({0.1F, -0.1F, 0.1F}));
  EXPECT_TRUE(map.insert({0.1F, 0.1F, -0.1F}));
  EXPECT_FALSE(map.insert({0.9F, 0.9F, 0.9F}));
  EXPECT_FALSE(map.insert({-0.9F, 0.9F, 0.9F}));
}

TEST(PointMap, RefusesPointsThatAreNotFiniteAndBearsFarOnes) {
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  constexpr float kInfinite = std::numeric_limits<float>::infinity();
  PointMap map(0.02);
  EXPECT_FALSE(map.insert({kNan, 0.0F, 0.0F}));
  EXPECT_FALSE(map.insert({0.0F, -kInfinite, 0.0F}));
  EXPECT_TRUE(map.insert({3e38F, -3e38F, 0.0F}));
  EXPECT_EQ(map.size(), 1U);
}

TEST(PointMap, TakesSome20BytesAVoxelHoweverManyPointsFallIntoIt) {
  PointMap map(0.5);
  const Points points = random_points(20000, 6.0);
  for (int repeat = 0; repeat < 10; ++repeat) map.insert(points);
  // 12 B per point, in a vector up to twice as large; 24 B for up to 64 voxels in a table at least
  // a quarter full
  EXPECT_LE(map.memory_bytes(), map.size() * (2 * 12 + 4 * 24 / 16));
  const std::size_t voxels = map.size();
  EXPECT_EQ(map.take().size(), voxels);
  EXPECT_EQ(map.size(), 0U);
  EXPECT_LT(map.memory_bytes(), 1024U);
  EXPECT_TRUE(map.insert(points.front()));
}

TEST(PointMap, AVoxelWithoutSizeIsRefused) {
  EXPECT_THROW(PointMap(0.0), InputError);
  EXPECT_THROW(PointMap{std::numeric_limits<double>::quiet_NaN()}, InputError);
}

TEST(VoxelFilter, IndicesNameTheFirstPointOfEachVoxel) {
  const Points points = random_points(5000, 3.0);
  Points kept;
  for (const std::uint32_t i : first_of_each_voxel(points, 0.5)) kept.push_back(points[i]);
  EXPECT_EQ(kept, first_ones(points, 0.5));
}

TEST(VoxelFilter, RoundedTowardsZeroTheCellAroundTheOriginIsTwiceAsWide) {
  const Points points{{-0.4F, 0.1F, 0.1F}, {0.4F, 0.1F, 0.1F},  {0.4F, -0.3F, -0.4F},
                      {0.6F, 0.1F, 0.1F},  {-0.6F, 0.1F, 0.1F}, {-0.9F, 0.2F, 0.2F}};
  EXPECT_EQ(first_of_each_voxel(points, 0.5, VoxelRounding::kTruncate),
            (std::vector<std::uint32_t>{0, 3, 4}));
  EXPECT_EQ(first_of_each_voxel(points, 0.5), (std::vector<std::uint32_t>{0, 1, 2, 3, 4}));
}

}  // namespace
}  // namespace lidarena::map
