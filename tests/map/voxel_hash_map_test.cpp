// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/map/voxel_hash_map.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>

#include "lidarena/base/error.hpp"
#include "lidarena/base/random.hpp"
#include "tests/map/sorted.hpp"

namespace lidarena::map {
namespace {

using Points = std::vector<Eigen::Vector3f>;
using Cell = std::array<int, 3>;

Cell cell_of(const Eigen::Vector3f& p, const VoxelHashMap::Options& options) {
  const auto index = [&](float coordinate) {
    const double cells = coordinate / options.voxel_size;
    const bool floor = options.rounding == VoxelRounding::kFloor;
    return static_cast<int>(floor ? std::floor(cells) : std::trunc(cells));
  };
  return {index(p.x()), index(p.y()), index(p.z())};
}

Points random_points(std::size_t count, double reach, std::uint64_t seed = 3) {
  SequentialRandom random(seed);
  Points points;
  for (std::size_t i = 0; i < count; ++i) {
    points.emplace_back(static_cast<float>(random.uniform(-reach, reach)),
                        static_cast<float>(random.uniform(-reach, reach)),
                        static_cast<float>(random.uniform(-reach, reach)));
  }
  return points;
}

/// Reference: the map as documented, with std::map.
struct SlowMap {
  VoxelHashMap::Options options;
  std::map<Cell, Points> cells{};

  void insert(const Eigen::Vector3f& p) {
    Points& cell = cells[cell_of(p, options)];
    if (static_cast<int>(cell.size()) >= options.max_points) return;
    for (const auto& q : cell) {
      if ((p - q).norm() < options.min_spacing) return;
    }
    cell.push_back(p);
  }
  void remove_far(const Eigen::Vector3f& center, double radius) {
    std::erase_if(
        cells, [&](const auto& entry) { return (entry.second.front() - center).norm() >= radius; });
  }
  double nearest_distance(const Eigen::Vector3f& query, double max_distance) const {
    const Cell home = cell_of(query, options);
    double best = max_distance;
    for (const auto& [cell, points] : cells) {
      if (std::abs(cell[0] - home[0]) > 1 || std::abs(cell[1] - home[1]) > 1 ||
          std::abs(cell[2] - home[2]) > 1)
        continue;
      for (const auto& p : points) best = std::min(best, static_cast<double>((p - query).norm()));
    }
    return best;
  }
  Points points() const {
    Points all;
    for (const auto& [cell, points] : cells) all.insert(all.end(), points.begin(), points.end());
    return all;
  }
};

void compare_with_the_slow_map(const VoxelHashMap::Options& options) {
  VoxelHashMap map(options);
  SlowMap slow{options};
  for (std::uint64_t round = 0; round < 5; ++round) {  // move, so that freed blocks are reused
    const Eigen::Vector3f center(static_cast<float>(round), 0.5F * static_cast<float>(round), 0.0F);
    for (Eigen::Vector3f p : random_points(4000, 2.0, round)) {
      p += center;
      map.insert(p);
      slow.insert(p);
    }
    map.remove_far(center, 2.5);
    slow.remove_far(center, 2.5);
    ASSERT_EQ(sorted(map.points()), sorted(slow.points()));
    EXPECT_EQ(map.size(), slow.points().size());
    EXPECT_EQ(map.cell_count(), slow.cells.size());
    for (const double max_distance : {0.05, 0.2, 2.0}) {
      for (const Eigen::Vector3f& offset : random_points(300, 3.0, 100 + round)) {
        const Eigen::Vector3f query = center + offset;
        const auto found = map.nearest(query, static_cast<float>(max_distance));
        const double expected = slow.nearest_distance(query, max_distance);
        ASSERT_EQ(found.has_value(), expected < max_distance);
        if (!found) continue;
        EXPECT_NEAR(std::sqrt(found->squared_distance), expected, 1e-6);  // rounding of float
        EXPECT_FLOAT_EQ((found->point - query).squaredNorm(), found->squared_distance);
      }
    }
  }
}

TEST(VoxelHashMap, HoldsWhatTheSlowMapHoldsAndFindsWhatItFinds) {
  compare_with_the_slow_map({0.5, 12, 0.1, VoxelRounding::kFloor});
}

TEST(VoxelHashMap, SoItDoesWithCellsRoundedTowardsZero) {
  compare_with_the_slow_map({0.5, 12, 0.1, VoxelRounding::kTruncate});
}

TEST(VoxelHashMap, ANeighborWithinOneEdgeIsTheTrueNearestOfAllPoints) {
  VoxelHashMap map({.voxel_size = 1.0, .max_points = 4096});
  const Points points = random_points(3000, 4.0);
  map.insert(points);
  for (const Eigen::Vector3f& query : random_points(500, 4.0, 9)) {
    float best = std::numeric_limits<float>::infinity();
    for (const auto& p : points) best = std::min(best, (p - query).squaredNorm());
    if (best >= 1.0F) continue;
    EXPECT_EQ(map.nearest(query, 10.0F)->squared_distance, best);
  }
}

TEST(VoxelHashMap, ACellTakesNoMoreThanItsLimitAndNothingNearerThanTheSpacing) {
  VoxelHashMap map({.voxel_size = 1.0, .max_points = 3, .min_spacing = 0.2});
  EXPECT_TRUE(map.insert({0.5F, 0.5F, 0.5F}));
  EXPECT_FALSE(map.insert({0.5F, 0.5F, 0.69F}));
  EXPECT_TRUE(map.insert({0.5F, 0.5F, 0.71F}));
  EXPECT_TRUE(map.insert({0.5F, 0.1F, 0.5F}));
  EXPECT_FALSE(map.insert({0.9F, 0.9F, 0.1F})) << "the cell is full";
  EXPECT_TRUE(map.insert({1.05F, 0.5F, 0.5F})) << "the spacing holds only within a cell";
  EXPECT_EQ(map.size(), 4U);
}

TEST(VoxelHashMap, MemoryFollowsTheContentsUpAndReturnsToUseWhenCellsAreDropped) {
  VoxelHashMap map({.voxel_size = 1.0});
  const std::size_t empty = map.memory_bytes();
  map.insert(random_points(20000, 10.0));
  const std::size_t full = map.memory_bytes();
  EXPECT_GE(full, empty + map.size() * sizeof(Eigen::Vector3f));
  // 12 B per point in blocks at least half used, the blocks left behind while growing (less than
  // the final block), 32 B per bucket at a load of 1/4 to 1/2, one page of 48 KiB
  EXPECT_LE(full, map.size() * 12 * 2 * 2 + map.cell_count() * 32 * 4 * 2 + 49152 + empty);
  for (int i = 0; i < 5; ++i) {
    map.remove_far(Eigen::Vector3f::Zero(), 1e-3);
    EXPECT_TRUE(map.empty());
    map.insert(random_points(20000, 10.0));
  }
  // freed blocks are reused by level; only the lists of free blocks grow
  EXPECT_LE(map.memory_bytes(), full * 5 / 4);
}

TEST(VoxelHashMap, OddInputDoesNoHarm) {
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  VoxelHashMap map({.voxel_size = 1.0});
  EXPECT_FALSE(map.insert({kNan, 0.0F, 0.0F}));
  EXPECT_TRUE(map.empty());
  EXPECT_FALSE(map.nearest({0.0F, 0.0F, 0.0F}, 1.0F));
  EXPECT_TRUE(map.insert({1e30F, 0.0F, 0.0F}));
  EXPECT_FALSE(map.nearest({kNan, 0.0F, 0.0F}, 1.0F));
  EXPECT_FALSE(map.nearest({-1e30F, 0.0F, 0.0F}, 1.0F));
  EXPECT_THROW(VoxelHashMap({.voxel_size = 0.0}), InputError);
  EXPECT_THROW(VoxelHashMap({.voxel_size = 1.0, .max_points = 0}), InputError);
}

TEST(VoxelHashMap, NearestFewAreThoseOfTheWholeMapWithinTheRadius) {
  const Points points = random_points(4000, 3.0);
  const Points queries = random_points(60, 3.2, 4);
  for (const VoxelRounding rounding : {VoxelRounding::kFloor, VoxelRounding::kTruncate}) {
    VoxelHashMap map({0.5, 4096, 0.0, rounding});
    map.insert(points);
    for (const float radius : {0.2F, 0.5F, 1.2F}) {  // one ring of cells, and three
      for (const Eigen::Vector3f& query : queries) {
        std::vector<float> expected;
        for (const auto& p : points) {
          const float squared = (p - query).squaredNorm();
          if (squared < radius * radius) expected.push_back(squared);
        }
        std::sort(expected.begin(), expected.end());
        expected.resize(std::min<std::size_t>(expected.size(), 20));
        std::array<Neighbor, 20> out;
        const std::size_t count = map.nearest(query, radius, out);
        std::vector<float> found;
        for (std::size_t i = 0; i < count; ++i) {
          EXPECT_EQ((out[i].point - query).squaredNorm(), out[i].squared_distance);
          found.push_back(out[i].squared_distance);
        }
        std::sort(found.begin(), found.end());
        EXPECT_EQ(found, expected);
      }
    }
  }
  const Eigen::Vector3f nowhere =
      Eigen::Vector3f::Constant(std::numeric_limits<float>::quiet_NaN());
  std::array<Neighbor, 3> out;
  EXPECT_EQ(VoxelHashMap(VoxelHashMap::Options{}).nearest(nowhere, 1.0F, out), 0U);
}

}  // namespace
}  // namespace lidarena::map
