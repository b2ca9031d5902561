// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/odometry/contacts.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "lidarena/base/random.hpp"

namespace lidarena::odometry {
namespace {

/// A corridor along x, 3 m wide and 2.4 m high, seen for 10 m to both sides.
std::vector<Contact> corridor(int points, float normal_error = 0.0F) {
  SequentialRandom random(1, 1);
  const auto within = [&](double half) {
    return static_cast<float>(half * (2.0 * random.uniform() - 1.0));
  };
  std::vector<Contact> contacts;
  for (int i = 0; i < points; ++i) {
    const float side = i % 2 == 0 ? 1.0F : -1.0F;
    if (i % 4 < 2)
      contacts.push_back(
          {{within(10.0), 1.5F * side, within(1.2)}, {0.0F, -side, 0.0F}, normal_error});
    else
      contacts.push_back(
          {{within(10.0), within(1.5), 1.2F * side}, {0.0F, 0.0F, -side}, normal_error});
  }
  return contacts;
}

/// The end of the corridor.
std::vector<Contact> end_of_corridor(int points, float normal_error = 0.0F) {
  return {static_cast<std::size_t>(points),
          {{10.0F, 0.0F, 0.0F}, {-1.0F, 0.0F, 0.0F}, normal_error}};
}

std::vector<Contact> operator+(std::vector<Contact> a, const std::vector<Contact>& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

TEST(Contacts, ACorridorIsOpenUntilItsEndIsSeen) {
  EXPECT_TRUE(leaves_a_direction_open(corridor(4000), 1.0));
  EXPECT_FALSE(leaves_a_direction_open(corridor(4000) + end_of_corridor(9), 1.0));
  EXPECT_TRUE(leaves_a_direction_open(corridor(4000) + end_of_corridor(7), 1.0))
      << "fewer than two in a thousand may be a wrong plane";
}

TEST(Contacts, TheLimitIsFiveCentimeters) {
  // Each contact stands for w returns, so that the standard deviation is 2 cm / sqrt(w).
  const std::vector<Contact> contacts = corridor(400) + end_of_corridor(1);
  EXPECT_TRUE(leaves_a_direction_open(contacts, 0.159));
  EXPECT_FALSE(leaves_a_direction_open(contacts, 0.161));
}

TEST(Contacts, ErrorsOfNormalsAreNothingThatIsSeen) {
  const float sigma = 0.012F;  // of the plane of 400 points of 2 cm in a cell of 0.3 m
  SequentialRandom random(3, 1);
  const auto normal = [&] { return static_cast<float>(random.normal()); };
  const auto disturbed = [&](float normal_error) {
    std::vector<Contact> contacts = corridor(4000, normal_error);
    for (Contact& contact : contacts) {
      const Eigen::Vector3f error = sigma * Eigen::Vector3f(normal(), normal(), normal());
      contact.normal = (contact.normal + error).normalized();
    }
    return contacts;
  };
  EXPECT_TRUE(leaves_a_direction_open(disturbed(4.0F * sigma), 100.0));
  EXPECT_FALSE(leaves_a_direction_open(disturbed(0.0F) + end_of_corridor(8), 100.0));
  const std::vector<Contact> with_end = disturbed(4.0F * sigma) + end_of_corridor(12, 4.0F * sigma);
  EXPECT_FALSE(leaves_a_direction_open(with_end, 1.0));
}

TEST(Contacts, ATurnIsOpenOnAFloorAndInARoundTube) {
  std::vector<Contact> floor;
  std::vector<Contact> tube;
  SequentialRandom random(4, 1);
  const auto within = [&](double half) {
    return static_cast<float>(half * (2.0 * random.uniform() - 1.0));
  };
  for (int i = 0; i < 1000; ++i) {
    floor.push_back({{within(4.0), within(4.0), -1.5F}, {0.0F, 0.0F, 1.0F}, 0.0F});
    const float angle = within(3.14);
    const Eigen::Vector3f out(0.0F, std::cos(angle), std::sin(angle));
    tube.push_back({1.5F * out + Eigen::Vector3f(within(5.0), 0.0F, 0.0F), -out, 0.0F});
  }
  EXPECT_TRUE(leaves_a_direction_open(floor, 1.0));
  EXPECT_TRUE(leaves_a_direction_open(tube + end_of_corridor(100), 1.0))
      << "it may turn about its axis";
  EXPECT_TRUE(leaves_a_direction_open({}, 1.0));
}

TEST(Contacts, AreOfPointsOnPlanesWithTheCoarseOneFirst) {
  map::LocalPlanes map({});
  SequentialRandom random(5, 1);
  std::vector<Eigen::Vector3f> wall;
  for (int i = 0; i < 20000; ++i) {
    const Eigen::Vector3d point(4.0 * random.uniform(), 4.0 * random.uniform(),
                                2.0 + 0.01 * random.normal());
    wall.push_back(point.cast<float>());
  }
  const Eigen::Vector3f sensor(2.0F, 2.0F, 0.5F);
  map.insert(wall, sensor);
  const std::vector<Contact> contacts = contacts_of(wall, sensor, map, 0.05);
  EXPECT_GT(contacts.size(), 19000U);
  for (const Contact& contact : contacts) {
    EXPECT_LT(contact.normal.z(), -0.98F) << "towards the sensor";
    EXPECT_LT(contact.normal.head<2>().norm(), contact.normal_error);
    EXPECT_NEAR(contact.arm.z(), 1.5F, 0.05F);
  }
  for (Eigen::Vector3f& point : wall) point.z() += 0.1F;
  EXPECT_TRUE(contacts_of(wall, sensor, map, 0.05).empty());
}

}  // namespace
}  // namespace lidarena::odometry
