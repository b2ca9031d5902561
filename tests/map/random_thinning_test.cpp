// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/map/random_thinning.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

namespace lidarena::map {
namespace {

TEST(RandomThinning, KeepsOnePointOfEachVoxelFromAllOverTheInput) {
  constexpr std::uint32_t kRounds = 1000;
  constexpr std::uint32_t kVoxels = 20;
  std::vector<VoxelKey> voxels;
  for (std::uint32_t i = 0; i < kRounds * kVoxels; ++i)
    voxels.push_back(voxel_key({static_cast<int>(i % kVoxels), 0, 0}));
  const auto kept = one_per_voxel(voxels);
  std::set<VoxelKey> seen;
  double mean = 0.0;
  for (const std::uint32_t index : kept) {
    seen.insert(voxels[index]);
    mean += static_cast<double>(index / kVoxels) / (kRounds * kVoxels);
  }
  EXPECT_EQ(kept.size(), kVoxels);
  EXPECT_EQ(seen.size(), kVoxels);
  // drawn uniformly from [0, 1): four standard deviations of the mean of 20
  EXPECT_NEAR(mean, 0.5, 4.0 / std::sqrt(12.0 * kVoxels));
}

TEST(RandomThinning, DrawsDifferentIndicesFromAllOfThem) {
  const auto some = drawn(1000, 100);
  ASSERT_EQ(some.size(), 100U);
  EXPECT_EQ(std::set(some.begin(), some.end()).size(), 100U);
  double mean = 0.0;
  for (const std::uint32_t index : some) mean += index / 100.0;
  EXPECT_NEAR(mean, 500.0, 4.0 * 1000.0 / std::sqrt(12.0 * 100.0));
  EXPECT_FALSE(std::is_sorted(some.begin(), some.end()));
  EXPECT_EQ(drawn(3, 5), (std::vector<std::uint32_t>{0, 1, 2}));
  EXPECT_EQ(drawn(0, 5).size(), 0U);
}

TEST(RandomThinning, CellsAboutZeroAreTwiceAsWideIfCoordinatesAreTruncated) {
  struct Item {
    Eigen::Vector3f position;
  };
  const std::vector<Item> items{{{-0.9F, 0.1F, 0.1F}}, {{0.9F, 0.1F, 0.1F}}, {{1.1F, 0.1F, 0.1F}}};
  const auto keys = voxels_of<Item>(items, 1.0);
  EXPECT_EQ(keys[0], voxel_key({-1, 0, 0}));
  EXPECT_EQ(keys[2], voxel_key({1, 0, 0}));
  EXPECT_EQ(voxels_of<Item>(items, 1.0, VoxelRounding::kTruncate)[0], keys[1]);
}

TEST(RandomThinning, SelectsInTheOrderOfTheIndices) {
  const std::vector<char> letters{'a', 'b', 'c'};
  const std::vector<std::uint32_t> indices{2, 0};
  EXPECT_EQ(selected<char>(letters, indices), (std::vector<char>{'c', 'a'}));
}

}  // namespace
}  // namespace lidarena::map
