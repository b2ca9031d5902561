// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

#include "lidarena/world/furniture.hpp"
#include "lidarena/world/house_furnish.hpp"

namespace lidarena {

/// The sides of a room, as its furniture sees them: a piece at kSouth faces +y.
enum class Side { kSouth, kEast, kNorth, kWest };

/// Finds free places for pieces, and keeps what was placed.
class Furnisher {
 public:
  using Piece = furniture::Piece;
  /// Number of a placed object; empty when no place was found.
  using Handle = std::optional<std::size_t>;

  Furnisher(const HousePlan& plan, const HouseConfig& config, SequentialRandom& random);

  /// With its back to a wall, its foot `z` meters up; any wall, or the given one.
  Handle against_wall(RoomUse use, const Piece& piece, double z = 0, std::optional<Side> side = {});
  /// Free in the room, about the fractions (u, v) of its floor, turned by quarters at will.
  Handle standing(RoomUse use, const Piece& piece, double u, double v);
  /// From the ceiling, about the fractions (u, v).
  Handle hanging(RoomUse use, const Piece& piece, double u, double v);
  /// On another object's table top.
  Handle on_top(Handle host, const Piece& piece);
  /// At the two long sides of a table, `count` in all, facing it and pushed under it.
  void around(RoomUse use, Handle host, const std::vector<Piece>& pieces);
  /// Before a window, from `z` upward.
  Handle at_window(const Opening& window, const Piece& piece, double z);
  /// Exactly there, whatever is in the way.
  Handle fixed(const Piece& piece, const Pose& pose);

  std::vector<PlacedObject> take() { return std::move(objects_); }

 private:
  bool is_free(RoomUse use, const Eigen::AlignedBox3d& box, Handle ignore) const;
  Handle try_place(RoomUse use, const Piece& piece, const Pose& pose, Handle ignore = {});
  Eigen::AlignedBox2d inner_floor(RoomUse use) const;

  const HousePlan& plan_;
  const HouseConfig& config_;
  SequentialRandom& random_;
  std::vector<Eigen::AlignedBox3d> keep_out_;  ///< before doors and windows
  std::vector<PlacedObject> objects_;
};

/// Least distance between a box and a polyline, to within 2 cm.
double distance_to_route(const Eigen::AlignedBox3d& box, const std::vector<Eigen::Vector3d>& route);

}  // namespace lidarena
