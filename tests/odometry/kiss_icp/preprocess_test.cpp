// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/odometry/kiss_icp/preprocess.hpp"

#include <gtest/gtest.h>
#include <tsl/robin_map.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "lidarena/base/random.hpp"
#include "tests/odometry/kiss_icp/motions.hpp"

namespace lidarena::odometry::kiss_icp {
namespace {

using se3::Vector6;
using Cell = std::array<int, 3>;

constexpr std::array kReleases{Release::kV0_2, Release::kHead};

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

TEST(Preprocess, APoseBelongsToTheMiddleOfTheScanInV02AndToTheLastPointInHead) {
  Scan scan = scan_of({600, 300, 0});  // not in order of time
  EXPECT_EQ(pose_instant(Release::kHead, estimation::times_of(scan, Time{5})), Time{1600});
  EXPECT_EQ(pose_instant(Release::kV0_2, estimation::times_of(scan, Time{5})), Time{1300});
  scan.points.clear();
  EXPECT_EQ(pose_instant(Release::kHead, estimation::times_of(scan, Time{500})), Time{1500});
  EXPECT_EQ(pose_instant(Release::kV0_2, estimation::times_of(scan, Time{500})), Time{1250});
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
Points in_table_order(const Points& points, double size, Release release) {
  struct Hash {
    std::uint32_t y_factor = 0;
    std::size_t operator()(const Cell& cell) const {
      return static_cast<std::uint32_t>(cell[0]) * 73856093U ^
             static_cast<std::uint32_t>(cell[1]) * y_factor ^
             static_cast<std::uint32_t>(cell[2]) * 83492791U;
    }
  };
  const bool truncate = release == Release::kV0_2;
  const auto index = [&](float coordinate) {
    return static_cast<int>(truncate ? std::trunc(coordinate / size)
                                     : std::floor(coordinate / size));
  };
  tsl::robin_map<Cell, Eigen::Vector3f, Hash> table(0, Hash{truncate ? 19349663U : 19349669U});
  table.reserve(points.size());
  for (const Eigen::Vector3f& p : points)
    table.insert({Cell{index(p.x()), index(p.y()), index(p.z())}, p});
  Points ordered;
  for (const auto& [cell, point] : table) ordered.push_back(point);
  return ordered;
}

bool before(const Eigen::Vector3f& a, const Eigen::Vector3f& b) {
  return std::lexicographical_compare(a.begin(), a.end(), b.begin(), b.end());
}

TEST(Preprocess, ThinnedPointsAreThoseOfTheProgramsTableInItsOrder) {
  for (const Release release : kReleases) {
    for (const std::size_t count : {4096U, 5000U}) {  // a power of two has the smallest table
      // 0.5 m is a power of two, so float and double agree on the edges of all cells
      const Points points = random_points(count, 3.0);
      Points expected = in_table_order(points, 0.5, release);
      Points thinned = thin(points, 0.5, release);
      ASSERT_EQ(thinned.size(), expected.size());
      // Where points want the same slots, the table moves some by a few places.
      std::size_t same = 0;
      for (std::size_t i = 0; i < thinned.size(); ++i) same += thinned[i] == expected[i] ? 1U : 0U;
      EXPECT_GT(same, thinned.size() * 9 / 10);
      std::sort(expected.begin(), expected.end(), before);
      std::sort(thinned.begin(), thinned.end(), before);
      EXPECT_EQ(thinned, expected);
    }
  }
  EXPECT_TRUE(thin({}, 0.5, Release::kHead).empty());
}

TEST(Preprocess, ASecondPassTakesItsPointsFromTheWholeScan) {
  // A line of points 1 cm apart is a scan in order of time. In each 1.5 m cell, one of 3 points
  // remains (0.5 m cells); if taken in input order, it would always be the first.
  Points line;
  for (int i = 0; i < 150000; ++i) line.emplace_back(0.01F * static_cast<float>(i), 0.0F, 0.0F);
  for (const Release release : kReleases) {
    const Points twice = thin(thin(line, 0.5, release), 1.5, release);
    ASSERT_EQ(twice.size(), 1000U);
    std::array<int, 3> thirds{};
    for (const auto& p : twice) ++thirds[static_cast<std::size_t>(std::fmod(p.x(), 1.5F) / 0.499F)];
    // 1000 draws among 3: 333 each, standard deviation 15; 5 sigma
    for (const int count : thirds) EXPECT_NEAR(count, 333, 75);
  }
}

}  // namespace
}  // namespace lidarena::odometry::kiss_icp
