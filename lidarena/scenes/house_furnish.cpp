// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/scenes/house_furnish.hpp"

#include "lidarena/scenes/furnisher.hpp"
#include "lidarena/scenes/furniture.hpp"

namespace lidarena::scenes {
namespace {

using namespace furniture;
using enum RoomUse;

/// Arguments of the functions that furnish the rooms.
struct Site {
  const HousePlan& plan;
  const HouseConfig& config;
  Craft& craft;
  Furnisher& place;
};

void hang_curtains(Site& s) {
  for (const Opening& window : s.plan.windows) {
    const bool small = window.width < 1;
    const bool upper = window.sill > s.config.story_height_m;
    if (small || upper) continue;
    const double foot = window.sill - 0.12;
    s.place.at_window(window, curtain(s.craft, window.width + 0.5, window.head + 0.1 - foot), foot);
  }
}

void build_gallery(Site& s) {
  if (!s.config.high_rooms) return;
  const GalleryPlan plan = plan_gallery(s.plan, s.config);
  const auto at = [](double x, double y) {
    Pose pose = Pose::Identity();
    pose.translation() = Eigen::Vector3d(x, y, 0);
    return pose;
  };
  const Eigen::Vector3d flight = plan.stairs.sizes();
  s.place.fixed(stairs(s.craft, flight.x(), flight.y(), flight.z(), kStairSteps),
                at(plan.stairs.center().x(), plan.stairs.min().y()));
  const Eigen::Vector3d slab = plan.floor.sizes();
  s.place.fixed(gallery(s.craft, {slab.x(), slab.y(), plan.floor.max().z()}, flight.x()),
                at(plan.floor.center().x(), plan.floor.min().y()));
  for (const double share : {0.45, 0.9}) {
    s.place.fixed(column(s.craft, plan.floor.min().z()),
                  at(plan.floor.min().x() + share * slab.x(), plan.floor.max().y() - 0.3));
  }
}

void furnish_living(Site& s) {
  auto& [plan, config, c, place] = s;
  build_gallery(s);
  place.standing(kLiving, rug(c, 2.4, 1.7), 0.45, 0.55);
  place.standing(kLiving, sofa(c, 3), 0.42, 0.40);
  const auto low_table =
      place.standing(kLiving, table(c, "coffee table", 1.1, 0.6, 0.42), 0.4, 0.6);
  place.on_top(low_table, bowl(c));
  place.on_top(low_table, book_pile(c));
  place.standing(kLiving, sofa(c, 1), 0.25, 0.65);
  place.standing(kLiving, sofa(c, 1), 0.65, 0.75);
  const auto board =
      place.against_wall(kLiving, cabinet(c, "television board", {1.5, 0.42, 0.45}, 3, 1));
  place.on_top(board, television(c));
  place.against_wall(kLiving, bookshelf(c, 0.9, 2.0));
  place.against_wall(kLiving, bookshelf(c, 0.8, 1.1));
  place.against_wall(kLiving, floor_lamp(c));
  for (const double height : {1.3, 0.9}) place.against_wall(kLiving, plant(c, height));
  for (const double z : {1.4, 3.4, 3.6}) {
    place.against_wall(kLiving, picture(c, "picture", c.random.uniform(0.5, 1.0), 0.6), z);
  }
  place.hanging(kLiving, pendant_lamp(c, 0.9), 0.75, 0.75);
}

void furnish_dining(Site& s) {
  auto& [plan, config, c, place] = s;
  place.standing(kDining, rug(c, 2.2, 1.8), 0.5, 0.4);
  const auto board = place.standing(kDining, table(c, "dining table", 1.6, 0.9, 0.75), 0.45, 0.45);
  std::vector<Piece> chairs;
  for (int i = 0; i < 6; ++i) chairs.push_back(chair(c));
  place.around(kDining, board, chairs);
  place.on_top(board, vase(c));
  place.on_top(board, bowl(c));
  const auto side = place.against_wall(kDining, cabinet(c, "sideboard", {1.3, 0.42, 0.85}, 3, 1));
  place.on_top(side, table_lamp(c));
  place.on_top(side, vase(c));
  place.against_wall(kDining, cabinet(c, "cupboard", {0.9, 0.4, 1.9}, 2, 2));
  place.against_wall(kDining, plant(c, 1.1));
  place.against_wall(kDining, picture(c, "picture", 0.7, 0.5), 1.4);
  place.hanging(kDining, pendant_lamp(c, 0.45), 0.45, 0.45);
}

void furnish_kitchen(Site& s) {
  auto& [plan, config, c, place] = s;
  const auto row = place.against_wall(kKitchen, kitchen_row(c, c.random.uniform(2.0, 2.4)), 0);
  place.on_top(row, sink(c));
  const auto hob = place.against_wall(kKitchen, stove(c));
  place.on_top(hob, pot(c));
  for (int i = 0; i < 2; ++i) place.on_top(row, pot(c));
  place.on_top(row, bowl(c));
  place.against_wall(kKitchen, fridge(c));
  for (int i = 0; i < 2; ++i) {
    place.against_wall(kKitchen, cabinet(c, "wall cupboard", {0.9, 0.34, 0.6}, 2, 1), 1.5);
  }
  const auto small =
      place.standing(kKitchen, table(c, "kitchen table", 0.9, 0.7, 0.75), 0.35, 0.75);
  place.around(kKitchen, small, {stool(c), stool(c)});
  place.on_top(small, vase(c));
  place.against_wall(kKitchen, basket(c, "bin", 0.15, 0.4));
  place.hanging(kKitchen, pendant_lamp(c, 0.4), 0.4, 0.7);
}

void furnish_bedrooms(Site& s) {
  auto& [plan, config, c, place] = s;
  place.against_wall(kMainBedroom, bed(c, 1.6));
  place.against_wall(kChildBedroom, bed(c, 0.95));
  for (const RoomUse room : {kMainBedroom, kMainBedroom, kChildBedroom}) {
    const auto stand = place.against_wall(room, cabinet(c, "nightstand", {0.45, 0.38, 0.5}, 1, 2));
    place.on_top(stand, table_lamp(c));
  }
  for (const RoomUse room : {kMainBedroom, kChildBedroom}) {
    place.against_wall(room, cabinet(c, "wardrobe", {1.1, 0.58, 2.0}, 2, 1));
    const auto work = place.against_wall(room, desk(c));
    place.around(room, work, {chair(c), chair(c)});  // one of the two sides is at the wall
    place.on_top(work, book_pile(c));
    place.on_top(work, table_lamp(c));
    place.against_wall(room, picture(c, "picture", 0.5, 0.6), 1.4);
    place.standing(room, rug(c, 1.5, 1.1), 0.5, 0.5);
    place.hanging(room, pendant_lamp(c, 0.35), 0.5, 0.5);
  }
  place.against_wall(kMainBedroom, picture(c, "mirror", 0.5, 1.5), 0.3);
  place.against_wall(kMainBedroom, plant(c, 0.8));
  place.against_wall(kChildBedroom, bookshelf(c, 0.8, 1.2));
  place.standing(kChildBedroom, beanbag(c), 0.3, 0.3);
  place.against_wall(kChildBedroom, basket(c, "toy basket", 0.22, 0.35));
  for (int i = 0; i < 3; ++i) {
    place.standing(kChildBedroom, toy_ball(c), c.random.uniform(0.2, 0.8),
                   c.random.uniform(0.2, 0.8));
  }
}

void furnish_bathroom(Site& s) {
  auto& [plan, config, c, place] = s;
  place.against_wall(kBathroom, bathtub(c));
  place.against_wall(kBathroom, toilet(c));
  place.against_wall(kBathroom, basin(c));
  place.against_wall(kBathroom, washing_machine(c));
  place.against_wall(kBathroom, picture(c, "mirror", 0.5, 0.7), 1.15);
  place.against_wall(kBathroom, towel_rail(c), 1.0);
  place.against_wall(kBathroom, basket(c, "laundry basket", 0.2, 0.55));
  place.hanging(kBathroom, pendant_lamp(c, 0.3), 0.5, 0.5);
}

void furnish_hall(Site& s) {
  auto& [plan, config, c, place] = s;
  place.against_wall(kHall, front_door(c), 0, Side::kNorth);
  place.against_wall(kHall, coat_rack(c));
  const auto shoes = place.against_wall(kHall, cabinet(c, "shoe cupboard", {0.9, 0.32, 0.9}, 2, 2));
  place.on_top(shoes, bowl(c));
  place.against_wall(kHall, picture(c, "mirror", 0.5, 1.1), 0.7);
  place.against_wall(kHall, plant(c, 1.2));
  place.against_wall(kHall, basket(c, "umbrella stand", 0.13, 0.5));
  place.standing(kHall, rug(c, 1.6, 1.0), 0.5, 0.7);
  for (const double z : {1.4, 3.2, 3.5})
    place.against_wall(kHall, picture(c, "picture", 0.8, 0.6), z);
  place.hanging(kHall, pendant_lamp(c, 1.1), 0.5, 0.5);
}

}  // namespace

std::vector<PlacedObject> furnish_house(const HousePlan& plan, const HouseConfig& config,
                                        std::uint64_t seed) {
  SequentialRandom places(seed, stream_of("house places"));
  SequentialRandom shapes(seed, stream_of("house shapes"));
  Craft craft{shapes, config.detail};
  Furnisher furnisher(plan, config, places);
  Site site{plan, config, craft, furnisher};
  hang_curtains(site);
  furnish_living(site);
  furnish_dining(site);
  furnish_kitchen(site);
  furnish_bedrooms(site);
  furnish_bathroom(site);
  furnish_hall(site);
  return furnisher.take();
}

}  // namespace lidarena::scenes
