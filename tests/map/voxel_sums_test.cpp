// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/map/voxel_sums.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "lidarena/base/error.hpp"
#include "lidarena/base/random.hpp"
#include "lidarena/map/voxel_filter.hpp"
#include "tests/map/sorted.hpp"

namespace lidarena::map {
namespace {

using Points = std::vector<Eigen::Vector3f>;

Points seeded_points(std::size_t count, std::uint64_t seed) {
  SequentialRandom random(seed);
  Points points;
  for (std::size_t i = 0; i < count; ++i) {
    const auto coordinate = [&] { return static_cast<float>(random.uniform(-2.0, 2.0)); };
    const float x = coordinate(), y = coordinate(), z = coordinate();
    points.emplace_back(x, y, z);
  }
  return points;
}

TEST(VoxelSums, MeansAreThoseOfAllPointsAtOnce) {
  const Points points = seeded_points(5000, 1);
  VoxelSums sums(0.25);
  sums.add(points);
  const Points means = sorted(sums.means());
  const Points expected = sorted(voxel_means(points, 0.25));
  ASSERT_EQ(means.size(), expected.size());
  EXPECT_EQ(sums.size(), expected.size());
  for (std::size_t i = 0; i < means.size(); ++i) {
    EXPECT_LT((means[i] - expected[i]).norm(), 3e-6F) << i;
  }
}

TEST(VoxelSums, WhatComesAndGoesLeavesNothingBehind) {
  std::vector<Points> parts;
  for (std::uint64_t seed = 0; seed < 12; ++seed) parts.push_back(seeded_points(700, seed));
  VoxelSums sums(0.2);
  std::size_t oldest = 0;
  for (std::size_t newest = 0; newest < parts.size(); ++newest) {
    sums.add(parts[newest]);
    if (newest - oldest == 4) sums.remove(parts[oldest++]);
    VoxelSums rebuilt(0.2);
    for (std::size_t i = oldest; i <= newest; ++i) rebuilt.add(parts[i]);
    EXPECT_EQ(sorted(sums.means()), sorted(rebuilt.means())) << newest;
  }
  VoxelSums cleared = sums;
  cleared.clear();
  cleared.add(parts[oldest]);
  VoxelSums rebuilt(0.2);
  rebuilt.add(parts[oldest]);
  EXPECT_EQ(cleared.means(), rebuilt.means());
  while (oldest < parts.size()) sums.remove(parts[oldest++]);
  EXPECT_EQ(sums.size(), 0U);
  EXPECT_TRUE(sums.means().empty());
}

TEST(VoxelSums, PointsThatAreNotFiniteAreLeftOut) {
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  const Points points{{0.1F, 0.1F, 0.1F}, {kNan, 0.0F, 0.0F}, {0.0F, kInfinity, 0.0F}};
  VoxelSums sums(0.5);
  sums.add(points);
  EXPECT_EQ(sums.size(), 1U);
  sums.remove(points);
  EXPECT_EQ(sums.size(), 0U);
  EXPECT_THROW(VoxelSums(0.0), InputError);
}

}  // namespace
}  // namespace lidarena::map
