// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/dataset/firing_order.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "lidarena/base/random.hpp"

namespace lidarena::dataset {
namespace {

/// Points of the given times; the intensity tells them apart.
std::vector<Point> points_at(const std::vector<std::int32_t>& times) {
  std::vector<Point> points(times.size());
  for (std::size_t i = 0; i < times.size(); ++i) {
    points[i].dt_ns = times[i];
    points[i].intensity = static_cast<float>(i);
  }
  return points;
}

void expect_as_stable_sort(std::vector<Point> points) {
  std::vector<Point> expected = points;
  std::ranges::stable_sort(expected, {}, &Point::dt_ns);
  sort_in_firing_order(points);
  ASSERT_EQ(points.size(), expected.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    EXPECT_EQ(points[i].dt_ns, expected[i].dt_ns) << i;
    EXPECT_EQ(points[i].intensity, expected[i].intensity) << i;
  }
}

TEST(FiringOrder, IsThatOfAStableSort) {
  constexpr auto kMin = std::numeric_limits<std::int32_t>::min();
  constexpr auto kMax = std::numeric_limits<std::int32_t>::max();
  expect_as_stable_sort({});
  expect_as_stable_sort(points_at({5}));
  expect_as_stable_sort(points_at({0, 0, 0}));
  expect_as_stable_sort(points_at({kMax, 3, -1, kMin, 0, kMax, 3, kMin, -1}));
}

TEST(FiringOrder, RowsOfASpinningSensorBecomeColumns) {
  std::vector<std::int32_t> times;
  for (int row = 0; row < 16; ++row)
    for (int column = 0; column < 256; ++column) times.push_back(column * 97'656);
  expect_as_stable_sort(points_at(times));
}

TEST(FiringOrder, RandomTimesWithRepetitions) {
  SequentialRandom random(3);
  std::vector<std::int32_t> times;
  for (int i = 0; i < 20'000; ++i)
    times.push_back(static_cast<std::int32_t>(random.uniform(-1e3, 1e8) / 1000.0) * 1000);
  expect_as_stable_sort(points_at(times));
}

}  // namespace
}  // namespace lidarena::dataset
