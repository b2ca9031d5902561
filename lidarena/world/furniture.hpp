// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <string>

#include "lidarena/base/random.hpp"
#include "lidarena/world/triangle_mesh.hpp"

/// Things that stand, lie and hang in a house. Sizes are in meters; each piece has its back at
/// y = 0, its front towards +y, its middle at x = 0, and stands on z = 0 (hangs from z = 0).
namespace lidarena::furniture {

/// How finely curved parts are cut, and the random numbers that draw sizes and shapes.
struct Craft {
  SequentialRandom& random;
  double detail = 1;

  /// `facets` at detail 1, and at least 4.
  int fine(int facets) const { return std::max(4, static_cast<int>(std::lround(facets * detail))); }
};

struct Piece {
  std::string kind;
  TriangleMesh mesh;
  double top = 0;  ///< height of its table top, on which small things may stand; 0: none
};

// Seats and tables (furniture_seating.cpp)
Piece sofa(Craft& craft, int seats);
Piece chair(Craft& craft);
Piece stool(Craft& craft);
Piece beanbag(Craft& craft);
Piece table(Craft& craft, const std::string& kind, double width, double depth, double height);
Piece desk(Craft& craft);
Piece bed(Craft& craft, double width);

// Things with shelves, doors and drawers (furniture_storage.cpp)
Piece bookshelf(Craft& craft, double width, double height);
Piece cabinet(Craft& craft, const std::string& kind, const Eigen::Vector3d& size, int columns,
              int rows);
Piece kitchen_row(Craft& craft, double width);
Piece sink(Craft& craft);
Piece stove(Craft& craft);
Piece fridge(Craft& craft);
Piece washing_machine(Craft& craft);
Piece front_door(Craft& craft);

// Lamps, plants, cloth and vessels (furniture_small.cpp)
Piece floor_lamp(Craft& craft);
Piece table_lamp(Craft& craft);
Piece pendant_lamp(Craft& craft, double drop);
Piece plant(Craft& craft, double height);
Piece vase(Craft& craft);
Piece bowl(Craft& craft);
Piece pot(Craft& craft);
Piece book_pile(Craft& craft);
Piece basket(Craft& craft, const std::string& kind, double radius, double height);
Piece toy_ball(Craft& craft);
Piece rug(Craft& craft, double width, double depth);
/// Two panels drawn aside on a rod `width` long.
Piece curtain(Craft& craft, double width, double height);
Piece picture(Craft& craft, const std::string& kind, double width, double height);
Piece television(Craft& craft);
Piece coat_rack(Craft& craft);

// Bathroom, and the living room's stairs and gallery (furniture_fixed.cpp)
Piece bathtub(Craft& craft);
Piece toilet(Craft& craft);
Piece basin(Craft& craft);
Piece towel_rail(Craft& craft);
/// Open stairs `width` wide (x) and `run` long (y) that climb by `rise` towards y = 0.
Piece stairs(Craft& craft, double width, double run, double rise, int steps);
/// A slab whose top lies at z = size.z(), with a railing along its front that leaves `gap` meters
/// free at low x.
Piece gallery(Craft& craft, const Eigen::Vector3d& size, double gap);
Piece column(Craft& craft, double height);

}  // namespace lidarena::furniture
