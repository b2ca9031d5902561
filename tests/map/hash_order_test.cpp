// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/map/hash_order.hpp"

#include <gtest/gtest.h>

namespace lidarena::map {
namespace {

using Order = std::vector<std::uint32_t>;

TEST(HashOrder, TheRichestItemMovesOn) {
  EXPECT_EQ(robin_hood_order(Order{3, 1, 2}, 8), (Order{1, 2, 0}));
  // 0 wants and gets slot 1, 1 slot 2; 2 wants slot 1 too, takes slot 2 from 1, and that one slot 3
  EXPECT_EQ(robin_hood_order(Order{1, 2, 1}, 8), (Order{0, 2, 1}));
  EXPECT_EQ(robin_hood_order(Order{7, 15, 0}, 8), (Order{1, 2, 0})) << "around the end";
  EXPECT_TRUE(robin_hood_order({}, 1).empty());
}

TEST(HashOrder, NegativeCellsWrapAround) {
  EXPECT_EQ(spatial_hash({1, 0, 0}, 5), 73856093U);
  EXPECT_EQ(spatial_hash({0, 2, 0}, 5), 10U);
  EXPECT_EQ(spatial_hash({0, -1, 0}, 5), 0U - 5U);
  EXPECT_EQ(spatial_hash({0, 1, 1}, 5), 5U ^ 83492791U);
}

}  // namespace
}  // namespace lidarena::map
