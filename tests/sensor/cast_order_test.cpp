// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/sensor/cast_order.hpp"

#include <gtest/gtest.h>

#include <set>

#include "tests/sensor/worlds.hpp"

namespace lidarena::sensor {
namespace {

using namespace testing;
using namespace world::testing;

std::vector<Beam> beams_of(const SensorConfig& config) {
  std::vector<Beam> beams;
  make_pattern(config)->beams(0, beams);
  return beams;
}

TEST(CastOrder, CastsEveryShotOnce) {
  for (const SensorConfig& config : {mid360(), ouster()}) {
    const CastOrder order(beams_of(config));
    for (const std::size_t count : {order.tile(), 3 * order.tile(), 3 * order.tile() - 5}) {
      std::set<std::size_t> places;
      for (std::size_t i = 0; i < count; ++i) places.insert(order.place(i, count));
      EXPECT_EQ(places.size(), count);
      EXPECT_EQ(*places.rbegin(), count - 1);
    }
  }
}

TEST(CastOrder, EightAtATimeAreNeighborsOfOneRow) {
  const auto beams = beams_of(ouster(2048));
  const CastOrder order(beams);
  ASSERT_EQ(order.tile(), 8U * 128U);
  std::vector<const Beam*> cast(order.tile());
  for (std::size_t i = 0; i < cast.size(); ++i) cast[order.place(i, cast.size())] = &beams[i];
  for (std::size_t i = 0; i < cast.size(); ++i) {
    const Beam& first = *cast[i - i % 8];
    EXPECT_EQ(cast[i]->ring, first.ring);
    // Seven columns of 2 pi / 2048.
    EXPECT_LT((cast[i]->direction - first.direction).norm(), 7 * 0.0031F);
  }
}

}  // namespace
}  // namespace lidarena::sensor
