// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/loop/place_descriptor.hpp"

#include <gtest/gtest.h>

#include "tests/loop/places.hpp"

namespace lidarena::loop {
namespace {

PlaceDescriptor at(double meters, double rotation_rad, std::uint64_t seed) {
  static const places::Points world = places::ring_corridor();
  const Pose pose = places::around_the_block(meters);
  return describe(places::seen_from(pose * make_pose(so3::exp({0, 0, rotation_rad}),
                                                     Eigen::Vector3d::Zero().eval()),
                                    world, 15.0, seed),
                  15.0);
}

TEST(PlaceDescriptor, TheSamePlaceLooksTheSameAndTellsTheTurn) {
  for (const double sectors : {0.0, 1.0, 7.0, -12.0, 29.0}) {
    const double rotation_rad = sectors * 2.0 * std::acos(-1.0) / PlaceDescriptor::kSectors;
    const Resemblance found = compare(at(13.0, 0.0, 1), at(13.0, rotation_rad, 2));
    EXPECT_LT(found.distance, 0.1) << "noise moves points across borders of cells";
    EXPECT_NEAR(found.rotation_rad, rotation_rad, 1e-9)
        << "the second place was seen rotated by it";
  }
}

TEST(PlaceDescriptor, AStepAsideLooksMoreAlikeThanAPlaceOfAnotherKind) {
  const PlaceDescriptor here = at(13.0, 0.0, 1);
  const double near = compare(here, at(13.3, 0.0, 2)).distance;
  EXPECT_LT(near, 0.2);
  places::Points room;
  places::add_room(room, 0.0F);
  const PlaceDescriptor other =
      describe(places::seen_from(places::standing(0.0, 0.0, 0.0), room, 15.0, 3), 15.0);
  EXPECT_GT(compare(here, other).distance, 2.0 * near);
}

TEST(PlaceDescriptor, NothingLooksLikeNothing) {
  const PlaceDescriptor empty = describe({}, 10.0);
  EXPECT_EQ(compare(empty, at(13.0, 0.0, 1)).distance, 1.0);
  EXPECT_EQ(compare(empty, empty).distance, 1.0);
}

}  // namespace
}  // namespace lidarena::loop
