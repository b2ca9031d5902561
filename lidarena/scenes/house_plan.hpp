// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <vector>

#include "lidarena/scenes/house.hpp"

namespace lidarena::scenes {

enum class RoomUse { kLiving, kDining, kKitchen, kMainBedroom, kBathroom, kHall, kChildBedroom };

struct Room {
  RoomUse use;
  Eigen::AlignedBox2d floor;  ///< between the center lines of its walls
  double height;              ///< of the ceiling
};

/// A rectangular hole in the wall whose center line is y = line (axis 0) or x = line (axis 1).
struct Opening {
  int axis;
  double line;
  double center;  ///< along the wall
  double width;
  double sill;  ///< lower edge
  double head;  ///< upper edge
  /// The center of the hole at height z, displaced by `ahead` (m) along the wall's positive normal.
  Eigen::Vector3d point(double ahead, double z) const;
};

/// Floor plan of a house.
struct HousePlan {
  std::vector<Room> rooms;  ///< in the order of RoomUse
  std::vector<Opening> doors;
  std::vector<Opening> windows;
  std::vector<Eigen::Vector3d> route;  ///< closed: the last point equals the first

  const Room& room(RoomUse use) const { return rooms[static_cast<std::size_t>(use)]; }
};

/// Position of the gallery and the stairs in the living room.
struct GalleryPlan {
  Eigen::AlignedBox3d floor;   ///< slab of the gallery, along the south wall
  Eigen::AlignedBox3d stairs;  ///< flight of stairs along the west wall, up towards -y
};
inline constexpr int kStairSteps = 16;

HousePlan plan_house(const HouseConfig& config, std::uint64_t seed);
GalleryPlan plan_gallery(const HousePlan& plan, const HouseConfig& config);

}  // namespace lidarena::scenes
