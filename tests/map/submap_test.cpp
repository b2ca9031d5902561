// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/map/submap.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <utility>

#include "lidarena/base/random.hpp"
#include "tests/map/sorted.hpp"

namespace lidarena::map {
namespace {

TEST(Submap, TakesTheNearTheOldestOfEachCellAndTheRecent) {
  const SubmapExtent extent{.radius_m = 5.0, .keyframe_spacing_m = 2.0, .recent_s = 10.0};
  const std::vector<std::pair<double, double>> time_and_x{{0, 0.5},  {20, 1.5}, {40, 2.5},
                                                          {60, 9.0}, {95, 3.0}, {96, 3.5}};
  std::vector<KeyframePlace> keyframes;
  for (const auto& [t, x] : time_and_x) keyframes.push_back({from_seconds(t), {x, 0, 0}});
  EXPECT_EQ(surrounding(keyframes, {3.5, 0, 0}, from_seconds(100.0), extent),
            (std::vector<std::uint32_t>{0, 2, 4, 5}));
}

TEST(Submap, FollowsAsIfMadeAnew) {
  SequentialRandom random(4);
  const auto seen = [&](std::uint32_t) {
    std::vector<Eigen::Vector3f> points;
    for (int i = 0; i < 400; ++i) {
      const auto coordinate = [&] { return static_cast<float>(random.uniform(-3.0, 3.0)); };
      const float x = coordinate(), y = coordinate(), z = coordinate();
      points.emplace_back(x, y, z);
    }
    return points;
  };
  std::vector<std::vector<Eigen::Vector3f>> clouds;
  for (std::uint32_t i = 0; i < 8; ++i) clouds.push_back(seen(i));
  std::vector<std::uint32_t> revisions(8, 0);
  const auto revision_of = [&](std::uint32_t i) { return revisions[i]; };
  const auto placed = [&](std::uint32_t i) { return clouds[i]; };
  Submap follows(0.2);
  const auto expect_as_anew = [&](const std::vector<std::uint32_t>& chosen) {
    follows.select(chosen, revision_of, placed);
    Submap anew(0.2);
    anew.select(chosen, revision_of, placed);
    EXPECT_EQ(sorted(follows.tree().points()), sorted(anew.tree().points()));
  };
  expect_as_anew({0, 1, 2, 3});
  expect_as_anew({1, 3, 4, 7});
  clouds[3] = seen(3);  // new points
  ++revisions[3];
  expect_as_anew({1, 3, 4, 7});
  for (auto& cloud : clouds) {  // moved by a loop
    for (Eigen::Vector3f& point : cloud) point.x() += 0.37F;
  }
  for (std::uint32_t& revision : revisions) ++revision;
  expect_as_anew({1, 3, 4, 7});
  expect_as_anew({0, 1, 2, 3, 4, 5, 6, 7});
  expect_as_anew({});
}

TEST(Submap, IsBuiltOnlyWhenTheSelectionChanges) {
  int asked = 0;
  const auto placed = [&](std::uint32_t) {
    ++asked;
    return std::vector<Eigen::Vector3f>{{1, 2, 3}};
  };
  const auto revision_of = [](std::uint32_t) { return 0U; };
  Submap submap(0.2);
  const std::vector<std::uint32_t> chosen{0, 1};
  submap.select(chosen, revision_of, placed);
  submap.select(chosen, revision_of, placed);
  EXPECT_EQ(asked, 2) << "once for each keyframe";
  EXPECT_EQ(submap.size(), 1U);
}

}  // namespace
}  // namespace lidarena::map
