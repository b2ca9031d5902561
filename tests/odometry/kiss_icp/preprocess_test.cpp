// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/odometry/kiss_icp_steps.hpp"

#include <gtest/gtest.h>
#include <tsl/robin_map.h>

#include <array>
#include <cmath>
#include <limits>

#include "lidarena/base/random.hpp"
#include "tests/odometry/kiss_icp/motions.hpp"

namespace lidarena::odometry::kiss_icp {
namespace {

using se3::Vector6;
using Cell = std::array<int, 3>;

/// As the published programs do.
constexpr CellOrder kV02{map::VoxelRounding::kTruncate, 19349663U};
constexpr CellOrder kHead{map::VoxelRounding::kFloor, 19349669U};

Scan scan_of(std::initializer_list<std::int32_t> times_ns) {
  Scan scan;
  scan.stamp = Time{1000};
  for (const std::int32_t dt_ns : times_ns) scan.points.emplace_back().dt_ns = dt_ns;
  return scan;
}

Points random_points(std::size_t count, double reach) {
  SequentialRandom random(7);
  const auto draw = [&] { return static_cast<float>(random.uniform(-reach, reach)); };
  Points points(count);
  for (Eigen::Vector3f& point : points) point = {draw(), draw(), draw()};
  return points;
}

TEST(Preprocess, TheRangeGateIsOpenAtBothEndsAndRefusesWhatIsNotFinite) {
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  constexpr float kInfinite = std::numeric_limits<float>::infinity();
  Config config;
  config.min_range_m = 1.0;
  config.max_range_m = 10.0;
  const Points kept = in_range({{1, 0, 0},
                                {1.01F, 0, 0},
                                {0, 9.99F, 0},
                                {0, 0, 10},
                                {0, 0, 0},
                                {kNan, 2, 2},
                                {kInfinite, 0, 0}},
                               config);
  EXPECT_EQ(kept, (Points{{1.01F, 0, 0}, {0, 9.99F, 0}}));
}

TEST(Preprocess, DisplacementIsHowFarAPointAtTheRangeMoves) {
  // for a rotation about z, all points of the circle of 50 m in the x-y plane move farthest
  const Pose turned = pose_of(0, 0, 0, 0, 0, 0.3);
  const Eigen::Vector3d point(30.0, 40.0, 0.0);
  EXPECT_NEAR(displacement(turned, 50.0), (turned * point - point).norm(), 1e-12);
  EXPECT_NEAR(displacement(pose_of(3, 0, 4, 0, 0, 0), 50.0), 5.0, 1e-12);
}

TEST(Preprocess, ThePreviousMotionFillsTheScanHoweverLongTheScanIs) {
  const Vector6 moved = vector6(0.2, 0, 0, 0, 0, 0.1);
  const auto twist_in = [&](std::initializer_list<std::int32_t> times_ns) {
    return twist_within(estimation::times_of(scan_of(times_ns), Time{0}), se3::exp(moved));
  };
  EXPECT_LT((twist_in({0, 50'000'000}) - moved / 0.05).norm(), 1e-12);
  EXPECT_LT((twist_in({0, 100'000'000}) - moved / 0.1).norm(), 1e-12);
  EXPECT_EQ(twist_in({7, 7}), Vector6::Zero()) << "no time passes";
}

/// Reference: the hash table of the published program, with room for two points per slot.
Points in_table_order(const Points& points, double size, const CellOrder& order) {
  struct Hash {
    std::uint32_t y_factor = 0;
    std::size_t operator()(const Cell& cell) const {
      return static_cast<std::uint32_t>(cell[0]) * 73856093U ^
             static_cast<std::uint32_t>(cell[1]) * y_factor ^
             static_cast<std::uint32_t>(cell[2]) * 83492791U;
    }
  };
  const bool truncate = order.rounding == map::VoxelRounding::kTruncate;
  const auto index = [&](float coordinate) {
    return static_cast<int>(truncate ? std::trunc(coordinate / size)
                                     : std::floor(coordinate / size));
  };
  tsl::robin_map<Cell, Eigen::Vector3f, Hash> table(0, Hash{order.hash_factor_y});
  table.reserve(points.size());
  for (const Eigen::Vector3f& p : points)
    table.insert({Cell{index(p.x()), index(p.y()), index(p.z())}, p});
  Points ordered;
  for (const auto& [cell, point] : table) ordered.push_back(point);
  return ordered;
}

TEST(Preprocess, ThinnedPointsAreThoseOfTheProgramsTableInItsOrder) {
  for (const CellOrder& order : {kV02, kHead}) {
    for (const std::size_t count : {4096U, 5000U}) {  // a power of two has the smallest table
      // 0.5 m is a power of two, so float and double agree on the edges of all cells
      const Points points = random_points(count, 3.0);
      EXPECT_EQ(thin(points, 0.5, order), in_table_order(points, 0.5, order));
    }
  }
  EXPECT_TRUE(thin({}, 0.5, kHead).empty());
}

TEST(Preprocess, ThinnedPointsThatWantOneSlotAreMovedOnAsInTheProgramsTable) {
  // In a table of 64 slots, cells 64 j along x want slot 0, and cells 64 j + 11 want the last slot:
  // 15 of the 16 points there are moved on across the end, before those that want slot 0.
  Points points;
  for (int i = 0; i < 32; ++i)
    points.emplace_back(64.0F * static_cast<float>(i / 2) + (i % 2 == 0 ? 0.5F : 11.5F), 0.5F,
                        0.5F);
  for (const CellOrder& order : {kV02, kHead}) {
    const Points thinned = thin(points, 1.0, order);
    EXPECT_EQ(thinned, in_table_order(points, 1.0, order));
    ASSERT_EQ(thinned.size(), 32U);
    EXPECT_EQ(std::fmod(thinned.front().x(), 64.0F), 11.5F);
  }
}

}  // namespace
}  // namespace lidarena::odometry::kiss_icp
