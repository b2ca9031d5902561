// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <string>

#include "lidarena/base/random.hpp"
#include "lidarena/world/triangle_mesh.hpp"

/// Meshes of furniture and other objects of a house. Sizes are in meters; each piece has its back
/// at y = 0, its front towards +y, its center at x = 0, and stands on z = 0 (or hangs from z = 0).
namespace lidarena::scenes::furniture {

/// Settings for building a piece: the resolution of curved parts, and the random number generator
/// for sizes and shapes.
struct Craft {
  SequentialRandom& random;
  double detail = 1;

  /// Number of facets: `facets` scaled by `detail`, at least 4.
  int fine(int facets) const { return std::max(4, static_cast<int>(std::lround(facets * detail))); }
};

struct Piece {
  std::string kind;
  world::TriangleMesh mesh;
  double top = 0;  ///< height of its table top, on which small objects may stand; 0: none
};

// Seats and tables (furniture_seating.cpp)
Piece sofa(Craft& craft, int seats);
Piece chair(Craft& craft);
Piece stool(Craft& craft);
Piece beanbag(Craft& craft);
Piece table(Craft& craft, const std::string& kind, double width, double depth, double height);
Piece desk(Craft& craft);
Piece bed(Craft& craft, double width);

// Furniture with shelves, doors and drawers (furniture_storage.cpp)
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
/// Two curtain panels drawn to the sides of a rod of length `width`.
Piece curtain(Craft& craft, double width, double height);
Piece picture(Craft& craft, const std::string& kind, double width, double height);
Piece television(Craft& craft);
Piece coat_rack(Craft& craft);

// Bathroom, and the living room's stairs and gallery (furniture_fixed.cpp)
Piece bathtub(Craft& craft);
Piece toilet(Craft& craft);
Piece basin(Craft& craft);
Piece towel_rail(Craft& craft);
/// Open stairs of width `width` (x) and length `run` (y) that climb by `rise` towards y = 0.
Piece stairs(Craft& craft, double width, double run, double rise, int steps);
/// A slab whose top lies at z = size.z(), with a railing along its front that is open over the
/// first `gap` meters in x.
Piece gallery(Craft& craft, const Eigen::Vector3d& size, double gap);
Piece column(Craft& craft, double height);

}  // namespace lidarena::scenes::furniture
