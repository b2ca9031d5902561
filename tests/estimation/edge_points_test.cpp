// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/estimation/edge_points.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace lidarena::estimation {
namespace {

/// A row of points with these ranges (m), one degree apart.
std::vector<Pixel> row_of(const std::vector<float>& ranges) {
  std::vector<Pixel> row;
  for (std::size_t i = 0; i < ranges.size(); ++i) {
    const float angle = 0.0175F * static_cast<float>(i);
    row.push_back({ranges[i] * Eigen::Vector3f(std::cos(angle), std::sin(angle), 0.0F), ranges[i],
                   static_cast<int>(i)});
  }
  return row;
}

TEST(EdgePoints, RoughnessIsTheSquareOfWhatTheNeighborsRangesExceedBy) {
  const auto rough = roughness(row_of({5, 5, 5, 6, 5, 5, 5, 5}), 2);
  EXPECT_EQ(rough[3], 16.0F) << "4 neighbors, each 1 m nearer";
  EXPECT_EQ(rough[2], 1.0F);
  EXPECT_EQ(rough[5], 1.0F);
  EXPECT_EQ(rough[1], 0.0F) << "too near to the row's end";
}

TEST(EdgePoints, TheFarSideOfAJumpIsBarred) {
  EdgeRule rule;
  rule.occluded_points = 3;
  rule.grazing_share = 0.5;
  const auto excluded = non_edge_points(row_of({8, 8, 8, 8, 8, 5, 5, 5, 9, 9, 9, 9, 9}), rule);
  const std::vector<bool> expected{false, false, true, true, true,  false, false,
                                   false, true,  true, true, false, false};
  EXPECT_EQ(excluded, expected);
}

TEST(EdgePoints, AGrazingPointIsBarred) {
  EdgeRule rule;
  rule.occluded_points = 0;
  const auto excluded = non_edge_points(row_of({5.0F, 5.2F, 5.4F, 5.6F, 5.62F}), rule);
  EXPECT_TRUE(excluded[1]) << "a difference of 0.2 m to both sides is 4 %";
  EXPECT_TRUE(excluded[2]);
  EXPECT_FALSE(excluded[3]) << "smooth to one side";
}

TEST(EdgePoints, AreTheCornersOfARoom) {
  // a square room of 10 m seen from its middle: corners at 45, 135, ... degrees
  std::vector<Pixel> row;
  for (int i = 0; i < 360; ++i) {
    const double angle = (i - 180) * std::acos(-1.0) / 180.0;
    const double range = 5.0 / std::max(std::abs(std::cos(angle)), std::abs(std::sin(angle)));
    const Eigen::Vector3f p(static_cast<float>(range * std::cos(angle)),
                            static_cast<float>(range * std::sin(angle)), 0.0F);
    row.push_back({p, static_cast<float>(range), i});
  }
  const std::vector<bool> edges =
      find_edges(row, EdgeRule{});  // 5 degrees beside a corner: 8 % less
  EXPECT_GE(std::count(edges.begin(), edges.end(), true), 4);
  for (std::size_t i = 0; i < row.size(); ++i) {
    if (!edges[i]) continue;
    EXPECT_GT(std::min(std::abs(row[i].position.x()), std::abs(row[i].position.y())), 4.0F)
        << "within 6 degrees of a corner";
  }
}

TEST(EdgePoints, ASectorHasNoMoreThanTheLimit) {
  std::vector<float> ranges;  // a point in seven stands out by 3 m
  for (int i = 0; i < 600; ++i) ranges.push_back(i % 7 == 0 ? 8.0F : 5.0F);
  EdgeRule rule;
  rule.occluded_points = 0;
  rule.grazing_share = 1.0;
  rule.per_sector = 3;
  const std::vector<bool> edges = find_edges(row_of(ranges), rule);
  EXPECT_EQ(std::count(edges.begin(), edges.end(), true), 6 * 3);
}

}  // namespace
}  // namespace lidarena::estimation
