// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

#include "lidarena/scenes/furniture.hpp"
#include "lidarena/scenes/house_furnish.hpp"

namespace lidarena::scenes {

/// The walls of a room: a piece of furniture with its back to the wall kSouth faces +y.
enum class Side { kSouth, kEast, kNorth, kWest };

/// Finds free places for pieces of furniture and stores the placed objects.
class Furnisher {
 public:
  using Piece = furniture::Piece;
  /// Index of a placed object; empty when no place was found, or the piece is left out.
  using Handle = std::optional<std::size_t>;

  Furnisher(const HousePlan& plan, const HouseConfig& config, SequentialRandom& random);

  /// Places the piece with its back to a wall, its base at height `z` (m); at a random wall unless
  /// `side` is given.
  Handle against_wall(RoomUse use, const Piece& piece, double z = 0, std::optional<Side> side = {});
  /// Places the piece near the fractions (u, v) of the floor, rotated by a random multiple of 90
  /// degrees.
  Handle standing(RoomUse use, const Piece& piece, double u, double v);
  /// Places the piece at the ceiling, near the fractions (u, v) of the floor.
  Handle hanging(RoomUse use, const Piece& piece, double u, double v);
  /// Places the piece on another object's table top.
  Handle on_top(Handle host, const Piece& piece);
  /// Places the pieces (chairs) at the two long sides of a table, facing it, partly under it.
  void around(RoomUse use, Handle host, const std::vector<Piece>& pieces);
  /// Places the piece in front of a window, its base at height `z` (m).
  Handle at_window(const Opening& window, const Piece& piece, double z);
  /// Places the piece exactly at `pose`, without a check for collisions.
  Handle fixed(const Piece& piece, const Pose& pose);

  std::vector<PlacedObject> take() { return std::move(objects_); }

 private:
  /// Whether the next piece is among the share of the furniture that is there.
  bool is_wanted();
  bool is_free(RoomUse use, const Eigen::AlignedBox3d& box, Handle ignore) const;
  Handle try_place(RoomUse use, const Piece& piece, const Pose& pose, Handle ignore = {});
  Eigen::AlignedBox2d inner_floor(RoomUse use) const;

  const HousePlan& plan_;
  const HouseConfig& config_;
  SequentialRandom& random_;
  std::vector<Eigen::AlignedBox3d> keep_out_;  ///< in front of doors and windows
  std::vector<PlacedObject> objects_;
};

/// Minimum distance (m) between a box and a polyline, to within 2 cm.
double distance_to_route(const Eigen::AlignedBox3d& box, const std::vector<Eigen::Vector3d>& route);

}  // namespace lidarena::scenes
