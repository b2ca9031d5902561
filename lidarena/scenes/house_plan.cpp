// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/scenes/house_plan.hpp"

#include <algorithm>

#include "lidarena/base/random.hpp"

namespace lidarena::scenes {
namespace {

constexpr double kBelowCeiling = 0.6;  // m
constexpr double kDoorApproach = 0.8;  // m before and behind a door where the route is straight

/// Center lines of the inner walls. South of y: living room, dining room, kitchen; north of it:
/// child's bedroom, hall, bathroom, main bedroom.
struct InnerWalls {
  double y;
  double living_dining, dining_kitchen;
  double child_hall, hall_bath, bath_main;
};

/// Rooms of equal size: three south of y, four north of it.
InnerWalls symmetric_walls(const HouseConfig& c) {
  return {0.5 * c.depth_m,  c.width_m / 3.0, c.width_m / 1.5,
          0.25 * c.width_m, 0.5 * c.width_m, 0.75 * c.width_m};
}

InnerWalls draw_walls(const HouseConfig& c, SequentialRandom& random) {
  const auto vary = [&] { return random.uniform(-c.variation_m, c.variation_m); };
  InnerWalls walls{};
  walls.y = 0.54 * c.depth_m + vary();
  walls.living_dining = 0.44 * c.width_m + vary();
  walls.dining_kitchen = 0.70 * c.width_m + vary();
  walls.child_hall = 0.29 * c.width_m + vary();
  walls.hall_bath = 0.53 * c.width_m + vary();
  walls.bath_main = 0.715 * c.width_m + vary();
  return walls;
}

std::vector<Room> make_rooms(const HouseConfig& c, const InnerWalls& w) {
  const auto room = [&](RoomUse use, double x0, double y0, double x1, double y1, int stories) {
    return Room{use, Eigen::AlignedBox2d(Eigen::Vector2d(x0, y0), Eigen::Vector2d(x1, y1)),
                stories * c.story_height_m};
  };
  const int high = c.high_rooms ? 2 : 1;
  return {room(RoomUse::kLiving, 0, 0, w.living_dining, w.y, high),
          room(RoomUse::kDining, w.living_dining, 0, w.dining_kitchen, w.y, 1),
          room(RoomUse::kKitchen, w.dining_kitchen, 0, c.width_m, w.y, 1),
          room(RoomUse::kMainBedroom, w.bath_main, w.y, c.width_m, c.depth_m, 1),
          room(RoomUse::kBathroom, w.hall_bath, w.y, w.bath_main, c.depth_m, 1),
          room(RoomUse::kHall, w.child_hall, w.y, w.hall_bath, c.depth_m, high),
          room(RoomUse::kChildBedroom, 0, w.y, w.child_hall, c.depth_m, 1)};
}

enum Door : std::size_t {
  kLivingDining,
  kDiningKitchen,
  kKitchenMain,
  kMainBath,
  kBathHall,
  kHallLiving,
  kLivingChild,
  kChildHall,
};

/// In the order of `Door`.
std::vector<Opening> make_doors(const HouseConfig& c, const InnerWalls& w,
                                SequentialRandom& random) {
  const double north = c.depth_m - w.y;
  const double variation = c.symmetric ? 0.0 : c.variation_m;
  const auto door = [&](int axis, double line, double center) {
    center += random.uniform(-variation, variation);
    return Opening{axis, line, center, c.door_width_m, 0, c.door_height_m};
  };
  const auto at = [&](double usual, double symmetric) { return c.symmetric ? symmetric : usual; };
  return {door(1, w.living_dining, 0.32 * c.depth_m),
          door(1, w.dining_kitchen, at(0.36, 0.32) * c.depth_m),
          door(0, w.y, at(0.85, 0.86) * c.width_m),
          door(1, w.bath_main, w.y + at(0.30, 0.5) * north),
          door(1, w.hall_bath, w.y + at(0.68, 0.5) * north),
          door(0, w.y, 0.5 * (w.child_hall + w.living_dining)),
          door(0, w.y, at(0.55 * w.child_hall, 0.14 * c.width_m)),
          door(1, w.child_hall, w.y + at(0.60, 0.5) * north)};
}

/// Makes a door a passage, symmetric about its center, as wide as the wall between its two rooms
/// allows.
void widen(Opening& door, const std::vector<Room>& rooms, const HouseConfig& c) {
  constexpr double kLeft = 0.3;  // m of wall beside and above a passage
  double half = 0.5 * c.passage_width_m;
  for (const Room& room : rooms) {
    const double from = room.floor.min()[door.axis], to = room.floor.max()[door.axis];
    const bool touches = room.floor.min()[1 - door.axis] == door.line ||
                         room.floor.max()[1 - door.axis] == door.line;
    if (touches && from < door.center && door.center < to)
      half = std::min({half, door.center - from - kLeft, to - door.center - kLeft});
  }
  door.width = std::max(door.width, 2.0 * half);
  door.head = c.story_height_m - kLeft;
}

std::vector<Opening> make_windows(const HouseConfig& c, const InnerWalls& w) {
  const double low = 0.9;                        // m, sill of ordinary windows
  const double head = 0.82 * c.story_height_m;   // m, upper edge of ordinary windows
  const double upper = 1.35 * c.story_height_m;  // sill of the windows of the second story
  const double upper_head = 1.8 * c.story_height_m;
  const double north = 0.5 * (w.y + c.depth_m);
  const double main = 0.5 * (w.bath_main + c.width_m);
  const double hall = 0.5 * (w.child_hall + w.hall_bath);
  std::vector<Opening> windows{{0, 0, 0.30 * w.living_dining, 1.6, low, head},
                               {0, 0, 0.72 * w.living_dining, 1.6, low, head},
                               {0, 0, 0.30 * w.living_dining, 1.6, upper, upper_head},
                               {0, 0, 0.72 * w.living_dining, 1.6, upper, upper_head},
                               {1, 0, 0.5 * w.y, 1.4, upper, upper_head},
                               {0, 0, 0.5 * (w.living_dining + w.dining_kitchen), 1.8, low, head},
                               {0, 0, 0.5 * (w.dining_kitchen + c.width_m), 1.2, 1.1, head},
                               {1, c.width_m, 0.5 * w.y, 1.2, 1.1, head},
                               {1, c.width_m, north, 1.5, low, head},
                               {0, c.depth_m, main, 1.3, low, head},
                               {0, c.depth_m, 0.5 * (w.hall_bath + w.bath_main), 0.7, 1.5, head},
                               {0, c.depth_m, hall, 1.5, upper, upper_head},
                               {0, c.depth_m, 0.5 * w.child_hall, 1.5, low, head},
                               {1, 0, north, 1.3, low, head}};
  if (!c.high_rooms)
    std::erase_if(windows, [&](const Opening& window) { return window.sill >= upper; });
  return windows;
}

/// Assembles the route from points in rooms and straight passages through doors.
class RouteBuilder {
 public:
  explicit RouteBuilder(const HousePlan& plan) : plan_(plan) {}

  /// Adds the point at fractions (u, v) of the room's floor, at height z (m) or, in a lower room,
  /// below its ceiling.
  RouteBuilder& in(RoomUse use, double u, double v, double z) {
    const auto& [_, floor, height] = plan_.room(use);
    const Eigen::Vector2d p = floor.min() + Eigen::Vector2d(u, v).cwiseProduct(floor.sizes());
    route_.emplace_back(p.x(), p.y(), std::min(z, height - kBelowCeiling));
    return *this;
  }
  /// Adds a passage through a door at half its height, along the wall's normal or against it.
  RouteBuilder& along(Door door) { return through(door, 1); }
  RouteBuilder& against(Door door) { return through(door, -1); }

  std::vector<Eigen::Vector3d> closed() {
    route_.push_back(route_.front());
    return std::move(route_);
  }

 private:
  RouteBuilder& through(Door number, double sign) {
    const Opening& door = plan_.doors[number];
    const double z = 0.5 * door.head;
    for (const double way : {-kDoorApproach, kDoorApproach}) {
      route_.push_back(door.point(sign * way, z));
    }
    return *this;
  }

  const HousePlan& plan_;
  std::vector<Eigen::Vector3d> route_;
};

/// Through all rooms once around, then the living room, the child's bedroom and the hall again.
/// Heights are 0.8 ... 2 m except in the two high rooms.
std::vector<Eigen::Vector3d> make_route(const HousePlan& plan) {
  using enum RoomUse;
  return RouteBuilder(plan)
      .in(kLiving, 0.60, 0.52, 1.2)
      .along(kLivingDining)
      .in(kDining, 0.35, 0.80, 1.7)
      .in(kDining, 0.70, 0.80, 1.8)
      .along(kDiningKitchen)
      .in(kKitchen, 0.42, 0.32, 1.6)
      .in(kKitchen, 0.66, 0.36, 1.5)
      .in(kKitchen, 0.64, 0.58, 1.4)
      .along(kKitchenMain)
      .in(kMainBedroom, 0.55, 0.60, 1.9)
      .in(kMainBedroom, 0.32, 0.52, 1.7)
      .against(kMainBath)
      .against(kBathHall)
      .in(kHall, 0.55, 0.66, 2.3)
      .in(kHall, 0.36, 0.48, 2.6)
      .against(kHallLiving)
      .in(kLiving, 0.66, 0.60, 2.4)
      .in(kLiving, 0.50, 0.50, 3.8)
      .in(kLiving, 0.32, 0.58, 2.6)
      .along(kLivingChild)
      .in(kChildBedroom, 0.50, 0.45, 1.6)
      .in(kChildBedroom, 0.52, 0.60, 1.3)
      .along(kChildHall)
      .in(kHall, 0.40, 0.62, 1.5)
      .in(kHall, 0.62, 0.56, 1.9)
      .in(kHall, 0.60, 0.36, 1.6)
      .against(kHallLiving)
      .in(kLiving, 0.60, 0.68, 1.6)
      .in(kLiving, 0.34, 0.66, 2.0)
      .in(kLiving, 0.32, 0.40, 2.0)
      .in(kLiving, 0.46, 0.36, 1.7)
      .closed();
}

}  // namespace

Eigen::Vector3d Opening::point(double ahead, double z) const {
  return axis == 0 ? Eigen::Vector3d(center, line + ahead, z)
                   : Eigen::Vector3d(line + ahead, center, z);
}

HousePlan plan_house(const HouseConfig& config, std::uint64_t seed) {
  SequentialRandom random(seed, stream_of("house plan"));
  const InnerWalls walls = config.symmetric ? symmetric_walls(config) : draw_walls(config, random);
  HousePlan plan;
  plan.rooms = make_rooms(config, walls);
  plan.doors = make_doors(config, walls, random);
  for (Opening& door : plan.doors) {
    if (config.passage_width_m > 0.0) widen(door, plan.rooms, config);
  }
  plan.windows = make_windows(config, walls);
  plan.route = make_route(plan);
  return plan;
}

GalleryPlan plan_gallery(const HousePlan& plan, const HouseConfig& config) {
  constexpr double kDepth = 1.3;    // m, of the gallery
  constexpr double kSlab = 0.18;    // m
  constexpr double kFlight = 0.95;  // m, width of the stairs
  constexpr double kFoot = 0.8;     // m of free floor in front of the first step
  const Eigen::AlignedBox2d& living = plan.room(RoomUse::kLiving).floor;
  const double face = 0.5 * config.wall_thickness_m;
  const double top = config.story_height_m + kSlab;
  const Eigen::Vector2d low = living.min().array() + face;
  const Eigen::Vector2d high = living.max().array() - face;
  GalleryPlan gallery;
  gallery.floor = {Eigen::Vector3d(low.x(), low.y(), config.story_height_m),
                   Eigen::Vector3d(high.x(), low.y() + kDepth, top)};
  gallery.stairs = {Eigen::Vector3d(low.x(), low.y() + kDepth, 0),
                    Eigen::Vector3d(low.x() + kFlight, high.y() - kFoot, top)};
  return gallery;
}

}  // namespace lidarena::scenes
