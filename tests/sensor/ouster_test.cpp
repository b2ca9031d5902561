// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/sensor/ouster.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "lidarena/base/error.hpp"
#include "tests/sensor/flights.hpp"

namespace lidarena::sensor {
namespace {

using testing::degrees;

TEST(Ouster, RowsSpanPlusMinus45p78DegreesFromTopToBottom) {
  EXPECT_NEAR(degrees(os0_128_row(0).altitude), 45.78, 0.005);  // figures given to two decimals
  EXPECT_NEAR(degrees(os0_128_row(127).altitude), -45.78, 0.005);
  double smallest = 90.0;
  double largest = 0.0;
  for (int row = 1; row < 128; ++row) {
    const double pitch = degrees(os0_128_row(row - 1).altitude - os0_128_row(row).altitude);
    smallest = std::min(smallest, pitch);
    largest = std::max(largest, pitch);
  }
  EXPECT_NEAR(smallest, 0.589, 0.0005);
  EXPECT_NEAR(largest, 0.911, 0.0005);
}

TEST(Ouster, FourPixelColumnsSpreadTheRowsInAzimuth) {
  const double top[] = {11.09, 3.66, -3.62, -10.75};
  const double center[] = {8.39, 2.80, -2.80, -8.39};
  for (int i = 0; i < 4; ++i) {
    EXPECT_NEAR(degrees(os0_128_row(i).azimuth_offset), top[i], 0.005);
    EXPECT_NEAR(degrees(os0_128_row(64 + i).azimuth_offset), center[i], 0.01);
  }
}

TEST(Ouster, PointsFollowTheMakersRangeFormula) {
  const OusterOs0Pattern pattern(1024, 10.0, "test");
  std::vector<Beam> beams;
  pattern.beams(0, beams);
  const double n = 0.02767;
  const double range = 17.3;
  for (int column = 0; column < 1024; column += 31) {
    for (int row = 0; row < 128; ++row) {
      const double e = 2 * std::numbers::pi * (1.0 - column / 1024.0);
      const auto [f, a] = os0_128_row(row);
      const Eigen::Vector3d expected((range - n) * std::cos(e - a) * std::cos(f) + n * std::cos(e),
                                     (range - n) * std::sin(e - a) * std::cos(f) + n * std::sin(e),
                                     (range - n) * std::sin(f));
      const Beam& beam = beams[static_cast<std::size_t>(column * 128 + row)];
      const Eigen::Vector3d point =
          beam.origin.cast<double>() +
          (range - static_cast<double>(beam.origin.norm())) * beam.direction.cast<double>();
      EXPECT_LT((point - expected).norm(), 4e-6);  // single precision directions at 17 m
    }
  }
}

TEST(Ouster, AllRowsOfAColumnFireTogetherAndColumnsFollowEvenly) {
  const OusterOs0Pattern pattern(2048, 10.0, "test");
  ASSERT_EQ(pattern.beams_per_scan(), 2048U * 128U);
  std::vector<Beam> beams;
  pattern.beams(5, beams);
  for (std::size_t i = 0; i < beams.size(); ++i) {
    EXPECT_EQ(beams[i].ring, i % 128);
    EXPECT_NEAR(beams[i].dt_ns, 48'828.125 * static_cast<double>(i / 128), 0.5);
  }
}

TEST(Ouster, TheHeadTurnsClockwiseFromTheConnector) {
  const OusterOs0Pattern pattern(512, 10.0, "test");
  std::vector<Beam> beams;
  pattern.beams(0, beams);
  EXPECT_GT(beams[0].origin.x(), 0.0F);                // column 0: along x
  EXPECT_LT(beams[128U * 128U].origin.y(), -0.0276F);  // a quarter revolution later: along -y
}

TEST(Ouster, HasTheFiveModesOfTheMakerAndNoOthers) {
  const std::pair<int, double> modes[] = {
      {512, 10.0}, {1024, 10.0}, {2048, 10.0}, {512, 20.0}, {1024, 20.0}};
  for (const auto& [columns, rate] : modes) {
    const OusterOs0Pattern pattern(columns, rate, "test");
    EXPECT_EQ(pattern.beams_per_scan(), static_cast<std::size_t>(columns) * 128U);
    EXPECT_EQ(pattern.period(), from_seconds(1.0 / rate));
  }
  EXPECT_THROW(OusterOs0Pattern(2048, 20.0, "test"), InputError);
  EXPECT_THROW(OusterOs0Pattern(1000, 10.0, "test"), InputError);
  EXPECT_THROW(OusterOs0Pattern(0, 10.0, "test"), InputError);
}

}  // namespace
}  // namespace lidarena::sensor
